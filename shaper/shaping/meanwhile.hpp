// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shaper/base/meanwhile.hpp"  // IWYU pragma: export
