// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillpoint {

// What the caller wants done now and then while a design runs: with doubles in software one may take a quarter of a
// minute. Called once a step of an iteration or oftener, from within add_shaper, on its stack; must not design itself.
// Every iteration is bounded, so a call says that the design comes nearer to its end.
struct Meanwhile {
  void (*run)(void* context) = nullptr;
  void* context = nullptr;

  void operator()() const {
    if (run != nullptr) run(context);
  }
};

}  // namespace stillpoint
