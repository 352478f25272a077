// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tools/plot/canvas.hpp"

namespace clearway::plot {

// Colours that people with the common kinds of colour blindness tell apart.
// Source: Okabe and Ito, "Color universal design", 2008; greys beside.
inline constexpr Colour kBlack{0.0, 0.0, 0.0};
inline constexpr Colour kOrange{0.902, 0.624, 0.0};
inline constexpr Colour kSkyBlue{0.337, 0.706, 0.914};
inline constexpr Colour kGreen{0.0, 0.620, 0.451};
inline constexpr Colour kYellow{0.941, 0.894, 0.259};
inline constexpr Colour kBlue{0.0, 0.447, 0.698};
inline constexpr Colour kVermillion{0.835, 0.369, 0.0};
inline constexpr Colour kPurple{0.800, 0.475, 0.655};
inline constexpr Colour kDarkPurple{0.56, 0.20, 0.42};
inline constexpr Colour kBrown{0.45, 0.25, 0.05};
inline constexpr Colour kTextGrey{0.25, 0.25, 0.25};
inline constexpr Colour kGridGrey{0.86, 0.86, 0.86};
inline constexpr Colour kPointGrey{0.62, 0.62, 0.62};
inline constexpr Colour kOccupiedGrey{0.45, 0.43, 0.41};
inline constexpr Colour kBetweenGrey{0.80, 0.78, 0.76};
inline constexpr Colour kUnknownTint{0.945, 0.95, 0.96};
inline constexpr Colour kUnknownHatch{0.86, 0.88, 0.91};
inline constexpr Colour kPanel{0.985, 0.985, 0.98};

}  // namespace clearway::plot
