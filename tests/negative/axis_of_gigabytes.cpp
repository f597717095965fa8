// SPDX-License-Identifier: Apache-2.0
// expect: longer lines than 8 MB a shaper are a mistake
#include "shaper/axis/axis.hpp"

#ifdef MUST_NOT_COMPILE
constexpr size_t kCapacity = (size_t{1} << 20) + 1;
#else
constexpr size_t kCapacity = size_t{1} << 20;
#endif
static_assert(sizeof(stillpoint::Axis<kCapacity>) > kCapacity, "instantiates it");
