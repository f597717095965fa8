// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillpoint {

// What the caller wants done now and then while long work of the background runs (a design, an identification): with
// doubles in software it may take a quarter of a minute. Called once a step of an iteration or oftener, on the caller's
// stack; must not start such work itself. Every iteration is bounded, so a call says that the end comes nearer.
struct Meanwhile {
  void (*run)(void* context) = nullptr;
  void* context = nullptr;

  void operator()() const {
    if (run != nullptr) run(context);
  }
};

}  // namespace stillpoint
