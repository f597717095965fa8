// SPDX-License-Identifier: Apache-2.0
// expect: Error
#include "shaper/base/status.hpp"

#ifdef MUST_NOT_COMPILE
int code = stillpoint::Error::kBusy;
#else
int code = static_cast<int>(stillpoint::Error::kBusy);
#endif
