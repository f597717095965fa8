// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillpoint {

// What the caller wants done now and then while long work of the background runs (a design, an identification): with
// doubles in software it may take a quarter of a minute. Called once a step of an iteration or oftener, on the caller's
// stack; must not start such work itself. Every iteration is bounded, so a call says that the end comes nearer.
// Where `given_up` points to something true after a call, an identification comes to its end at once, without a result.
struct Meanwhile {
  void (*run)(void* context) = nullptr;
  void* context = nullptr;
  const bool* given_up = nullptr;

  void operator()() const {
    if (run != nullptr) run(context);
  }
  bool is_given_up() const { return given_up != nullptr && *given_up; }
};

}  // namespace stillpoint
