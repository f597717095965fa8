// SPDX-License-Identifier: Apache-2.0
// expect: conversion
#include "shaper/base/signal.hpp"

stillpoint::Signal from_floating_point(double position);

stillpoint::Signal from_floating_point(double position) {
#ifdef MUST_NOT_COMPILE
  return position;
#else
  return static_cast<stillpoint::Signal>(position);
#endif
}
