// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// FreshnessWatch stands in the one header that base drivers take with them.
#include "common/core/guard/base_gate.hpp"
