// SPDX-License-Identifier: Apache-2.0
// What a Modbus RTU slave must answer, byte for byte, from the application protocol specification (V1.1b3), the serial
// line guide (V1.02) and this drive's register map. The same table runs against the host's drive and the emulated chip.
#pragma once

#include <string>
#include <vector>

#include "tests/firmware/rig.hpp"

namespace stillpoint::testing {

struct ConformanceRow {
  Bytes frame;   // as it goes out, CRC and all
  Bytes answer;  // unit and PDU; empty: silence
};

// Leaves the drive as it found it, so that a group can be repeated.
struct ConformanceGroup {
  std::string name;
  std::vector<ConformanceRow> rows;
};

class ConformanceTable {
 public:
  ConformanceTable() {
    add_functions();
    add_reads();
    add_writes();
    add_order();
    add_mask_writes();
    add_read_writes();
    add_diagnostics();
    add_identification();
    add_broadcasts();
    add_framing();
  }

  const std::vector<ConformanceGroup>& groups() const { return groups_; }

 private:
  static Bytes to_unit(uint8_t unit, const Bytes& pdu) {
    Bytes body{unit};
    body.insert(body.end(), pdu.begin(), pdu.end());
    return body;
  }
  static Bytes padded(Bytes pdu, size_t length, uint8_t with = 0) {
    pdu.resize(length, with);
    return pdu;
  }

  void group(const char* name) { groups_.push_back({name, {}}); }
  void row(const Bytes& frame, const Bytes& answer) { groups_.back().rows.push_back({frame, answer}); }
  void ask(const Bytes& pdu, const Bytes& answer) { row(framed(to_unit(1, pdu)), to_unit(1, answer)); }
  void refused(const Bytes& pdu, uint8_t code) { ask(pdu, {static_cast<uint8_t>(pdu[0] | 0x80), code}); }
  void echoed(const Bytes& pdu) { ask(pdu, pdu); }
  void silent(const Bytes& frame) { row(frame, {}); }
  void ignored(const Bytes& pdu, uint8_t unit = 1) { silent(framed(to_unit(unit, pdu))); }
  // Something is there and answers.
  void heard() { ask({3, 0x00, 0x06, 0, 2}, {3, 4, 0x12, 0x34, 0x56, 0x78}); }

  void add_functions() {
    group("functions that are none");
    for (uint32_t function = 0; function < 256; ++function) {
      const bool known = function == 3 || function == 4 || function == 6 || function == 8 || function == 16 ||
                         function == 22 || function == 23 || function == 43;
      if (!known) refused({static_cast<uint8_t>(function), 0, 0, 0, 1}, 1);
    }
    refused({7}, 1);
  }

  void add_reads() {
    group("reads: quantities, gaps, ends");
    for (const uint8_t f : Bytes{3, 4}) {
      refused({f, 0x01, 0x00, 0, 0}, 3);
      ask({f, 0x00, 0x00, 0, 1}, {f, 2, 0x01, 0x00});
      ask({f, 0x00, 0x06, 0, 2}, {f, 4, 0x12, 0x34, 0x56, 0x78});
      ask({f, 0x00, 0x07, 0, 1}, {f, 2, 0x56, 0x78});
      ask({f, 0x01, 0x00, 0, 34}, padded({f, 68}, 70));
      refused({f, 0x01, 0x00, 0, 125}, 2);
      refused({f, 0x01, 0x00, 0, 126}, 3);
      refused({f, 0x01, 0x00, 0xFF, 0xFF}, 3);
      refused({f, 0x00, 0x09, 0, 2}, 2);  // runs into a gap
      refused({f, 0x00, 0x0A, 0, 1}, 2);
      refused({f, 0xFF, 0xFF, 0, 1}, 2);
      refused({f, 0xFF, 0xFF, 0, 2}, 2);  // past the end
      refused({f, 0x00, 0x00, 0}, 3);
      refused({f, 0x00, 0x00, 0, 1, 0}, 3);
      refused({f}, 3);
    }
  }

  void add_writes() {
    group("writes: quantities, byte counts, halves, all or nothing");
    echoed({6, 0x01, 0x00, 0, 3});
    ask({3, 0x01, 0x00, 0, 1}, {3, 2, 0, 3});
    refused({6, 0x01, 0x00, 0, 5}, 3);
    refused({6, 0x00, 0x41, 0, 0}, 2);  // read only
    refused({6, 0x00, 0x44, 0, 1}, 3);  // high half
    refused({6, 0x00, 0x45, 0, 1}, 3);
    refused({6, 0x01, 0x00, 0}, 3);
    refused({6, 0x01, 0x00, 0, 1, 0}, 3);
    ask({16, 0x01, 0x00, 0, 1, 2, 0, 0}, {16, 0x01, 0x00, 0, 1});
    refused({16, 0x01, 0x00, 0, 0, 0}, 3);
    refused(padded({16, 0x01, 0x00, 0, 123, 246}, 252), 2);
    refused(padded({16, 0x01, 0x00, 0, 124, 248}, 253), 3);
    refused({16, 0x01, 0x00, 0, 1, 3, 0, 0}, 3);
    refused({16, 0x01, 0x00, 0, 1, 2, 0}, 3);
    refused({16, 0x01, 0x00, 0, 1, 2, 0, 0, 0}, 3);
    refused({16, 0x01, 0x00}, 3);
    refused({16, 0x00, 0x60, 0, 3, 6, 0, 0, 0, 5, 0, 0}, 3);        // half of the second
    refused({16, 0x00, 0x60, 0, 4, 8, 0, 0, 0, 5, 0, 0, 0, 0}, 3);  // the second out of range
    ask({3, 0x00, 0x60, 0, 2}, {3, 4, 0x00, 0x12, 0x4F, 0x80});
  }

  void add_order() {
    group("exceptions: function, quantity, address, value, state");
    refused({3, 0xFF, 0xFF, 0, 0}, 3);
    refused({16, 0xFF, 0xFF, 0, 0, 0}, 3);
    refused({16, 0x00, 0x42, 0, 2, 4, 0, 99, 0, 0}, 2);
    refused({16, 0x00, 0x58, 0, 2, 4, 0, 0, 0, 0}, 3);
    refused({16, 0x00, 0x58, 0, 2, 4, 0, 0, 0, 5}, 6);
    ask({3, 0x00, 0x12, 0, 2}, {3, 4, 0x80, 0x00, 0x00, 0x58});
    refused({6, 0x00, 0x14, 0x53, 0x41}, 6);  // save, locked
    refused({6, 0x00, 0x14, 0x12, 0x34}, 3);  // no key at all
  }

  void add_mask_writes() {
    group("mask write");
    echoed({6, 0x00, 0x72, 0, 0x12});
    echoed({22, 0x00, 0x72, 0x00, 0xF2, 0x00, 0x25});  // the specification's example
    ask({3, 0x00, 0x72, 0, 1}, {3, 2, 0, 0x17});
    refused({22, 0x00, 0x0A, 0, 0, 0, 0}, 2);
    refused({22, 0x00, 0x41, 0, 0, 0, 0}, 2);
    refused({22, 0x00, 0x44, 0xFF, 0xFF, 0, 0}, 3);
    refused({22, 0x01, 0x00, 0, 0, 0, 9}, 3);
    refused({22, 0x00, 0x72, 0, 0, 0}, 3);
    refused({22, 0x00, 0x72, 0, 0, 0, 0, 0}, 3);
    refused({22, 0x00, 0x6E, 0xFF, 0xFF, 0, 0}, 6);  // locked
    echoed({6, 0x00, 0x72, 0, 20});
  }

  void add_read_writes() {
    group("read and write");
    ask({23, 0x01, 0x00, 0, 2, 0x01, 0x00, 0, 1, 2, 0, 4}, {23, 4, 0, 4, 0, 0});  // written first
    ask({23, 0x00, 0x06, 0, 2, 0x01, 0x00, 0, 1, 2, 0, 2}, {23, 4, 0x12, 0x34, 0x56, 0x78});
    refused({23, 0x00, 0x0A, 0, 1, 0x01, 0x00, 0, 1, 2, 0, 3}, 2);
    refused({23, 0x01, 0x00, 0, 1, 0x00, 0x41, 0, 1, 2, 0, 3}, 2);
    refused({23, 0x01, 0x00, 0, 1, 0x01, 0x00, 0, 1, 2, 0, 9}, 3);
    refused({23, 0x01, 0x00, 0, 1, 0x00, 0x6E, 0, 1, 2, 0, 9}, 6);
    ask({3, 0x01, 0x00, 0, 1}, {3, 2, 0, 2});  // what was refused wrote nothing
    refused({23, 0x01, 0x00, 0, 0, 0x01, 0x00, 0, 1, 2, 0, 0}, 3);
    refused({23, 0x01, 0x00, 0, 126, 0x01, 0x00, 0, 1, 2, 0, 0}, 3);
    refused({23, 0x01, 0x00, 0, 125, 0x01, 0x00, 0, 1, 2, 0, 0}, 2);
    refused({23, 0x01, 0x00, 0, 1, 0x01, 0x00, 0, 0, 0}, 3);
    refused(padded({23, 0x01, 0x00, 0, 1, 0x01, 0x00, 0, 121, 242}, 252), 2);
    refused(padded({23, 0x01, 0x00, 0, 1, 0x01, 0x00, 0, 122, 244}, 253), 3);
    refused({23, 0x01, 0x00, 0, 1, 0x01, 0x00, 0, 1, 4, 0, 0}, 3);
    refused({23, 0x01, 0x00, 0, 1, 0x01, 0x00, 0, 1, 2, 0}, 3);
    refused({23, 0x01, 0x00, 0, 1}, 3);
    echoed({6, 0x01, 0x00, 0, 0});
  }

  void add_diagnostics() {
    group("diagnostics");
    echoed({8, 0, 0, 0xA5, 0x37});
    echoed({8, 0, 0, 1, 2, 3, 4, 5, 6});
    echoed(padded({8, 0, 0}, 253, 0x5A));
    refused({8, 0, 0}, 3);
    refused({8, 0, 0, 1}, 3);
    refused({8, 0, 0, 1, 2, 3}, 3);
    refused({8}, 3);
    refused({8, 0}, 3);
    for (const uint8_t sub : Bytes{2, 3, 5, 6, 7, 8, 9, 19, 20, 21, 255}) refused({8, 0, sub, 0, 0}, 1);
    refused({8, 1, 0, 0, 0}, 1);
    for (const uint8_t sub : Bytes{1, 4, 10, 11, 12, 13, 14, 15, 16, 17, 18}) {
      refused({8, 0, sub, 0, 1}, 3);
      refused({8, 0, sub, 0, 0, 0}, 3);
    }
    echoed({8, 0, 10, 0, 0});
    echoed({8, 0, 1, 0, 0});
    echoed({8, 0, 1, 0xFF, 0});
    for (const uint8_t sub : Bytes{12, 13, 15, 16, 17, 18}) ask({8, 0, sub, 0, 0}, {8, 0, sub, 0, 0});
    group("listen only");
    ignored({8, 0, 4, 0, 0});
    ignored({3, 0x00, 0x06, 0, 2});
    ignored({6, 0x01, 0x00, 0, 3});
    ignored({6, 0x01, 0x00, 0, 3}, 0);
    ignored({8, 0, 0, 1, 2});
    ignored({99, 0});
    ignored({8, 0, 1, 0, 7});  // no restart
    ignored({8, 0, 1, 0, 0});
    ask({3, 0x01, 0x00, 0, 1}, {3, 2, 0, 0});
  }

  void add_identification() {
    const Bytes vendor = {0, 10, 's', 't', 'i', 'l', 'l', 'p', 'o', 'i', 'n', 't'};
    const Bytes code = {1, 2, 'S', 'P'};
    const Bytes revision = {2, 3, '0', '.', '1'};
    const auto response = [](uint8_t access, const std::vector<Bytes>& objects) {
      Bytes pdu{43, 14, access, 0x82, 0, 0, static_cast<uint8_t>(objects.size())};
      for (const Bytes& object : objects) pdu.insert(pdu.end(), object.begin(), object.end());
      return pdu;
    };
    group("device identification");
    ask({43, 14, 1, 0}, response(1, {vendor, code, revision}));
    ask({43, 14, 1, 1}, response(1, {code, revision}));
    ask({43, 14, 1, 2}, response(1, {revision}));
    ask({43, 14, 1, 9}, response(1, {vendor, code, revision}));  // none such: from the beginning
    const std::string name = "stillpoint drive";
    const std::string model = "one axis, shaped";
    Bytes product{4, static_cast<uint8_t>(name.size())};
    product.insert(product.end(), name.begin(), name.end());
    Bytes kind{5, static_cast<uint8_t>(model.size())};
    kind.insert(kind.end(), model.begin(), model.end());
    ask({43, 14, 2, 0}, response(2, {vendor, code, revision, product, kind}));
    ask({43, 14, 2, 4}, response(2, {product, kind}));
    ask({43, 14, 3, 0}, response(3, {vendor, code, revision, product, kind}));
    ask({43, 14, 4, 0}, response(4, {vendor}));
    ask({43, 14, 4, 2}, response(4, {revision}));
    ask({43, 14, 4, 5}, response(4, {kind}));
    refused({43, 14, 4, 3}, 2);
    refused({43, 14, 4, 128}, 2);
    refused({43, 14, 0, 0}, 3);
    refused({43, 14, 5, 0}, 3);
    refused({43, 14, 1}, 3);
    refused({43, 14, 1, 0, 0}, 3);
    refused({43}, 3);
    refused({43, 13, 1, 0}, 1);
  }

  void add_broadcasts() {
    group("broadcasts are executed and not answered");
    ignored({6, 0x01, 0x00, 0, 3}, 0);
    ask({3, 0x01, 0x00, 0, 1}, {3, 2, 0, 3});
    ignored({6, 0x01, 0x00, 0, 9}, 0);
    ignored({3, 0x00, 0x06, 0, 2}, 0);
    ignored({99}, 0);
    ignored({22, 0x01, 0x00, 0, 0, 0, 1}, 0);
    ask({3, 0x01, 0x00, 0, 1}, {3, 2, 0, 1});
    ignored({16, 0x01, 0x00, 0, 1, 2, 0, 0}, 0);
    ask({3, 0x01, 0x00, 0, 1}, {3, 2, 0, 0});
  }

  void add_framing() {
    group("other units");
    for (const uint8_t unit : Bytes{2, 17, 246, 247, 248, 249, 250, 251, 252, 253, 254, 255}) {
      ignored({3, 0x00, 0x06, 0, 2}, unit);
      ignored({6, 0x01, 0x00, 0, 3}, unit);
    }
    ask({3, 0x01, 0x00, 0, 1}, {3, 2, 0, 0});
    group("broken frames");
    const Bytes good = framed({1, 3, 0x00, 0x06, 0, 2});
    for (size_t byte = 0; byte < good.size(); ++byte) {
      Bytes bad = good;
      bad[byte] = static_cast<uint8_t>(bad[byte] ^ 0x10);
      silent(bad);
    }
    for (const Bytes& runt : {Bytes{1}, Bytes{1, 3}, Bytes{0xFF, 0xFF, 0xFF}, framed({1}), framed({0})}) silent(runt);
    heard();
    for (size_t bytes = 1; bytes < good.size(); ++bytes) {
      silent(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(bytes)));
    }
    heard();
    Bytes twice = good;
    twice.insert(twice.end(), good.begin(), good.end());
    silent(twice);  // back to back, no silence between
    heard();
    silent(framed(padded({1, 3}, 256)));  // two bytes too long
    silent(padded({}, 700, 0x55));
    heard();
  }

  std::vector<ConformanceGroup> groups_;
};

}  // namespace stillpoint::testing
