# Usage: cmake -D HEADER=file.hpp -P HardenLcmTypes.cmake
# Rewrites a header of lcm-gen 1.3.1 in place so that decoding a hostile message returns -1.
# As generated, an array's length is trusted: a negative one throws, a large one allocates what it
# says and overflows the int arithmetic of the length check, which then reads beyond the message.
# Every array element takes at least one byte of the message, and every string at least its NUL.

file(READ ${HEADER} text)
string(REGEX REPLACE
  "(this->[a-z_A-Z0-9]+)\\.resize\\((this->[a-z_A-Z0-9]+)\\);"
  "if(\\2 < 0 || \\2 > maxlen - pos) return -1;\n    \\1.resize(static_cast<std::size_t>(\\2));"
  text "${text}")
string(REGEX REPLACE
  "if\\((__[a-z_A-Z0-9]+) > maxlen - pos\\) return -1;"
  "if(\\1 < 1 || \\1 > maxlen - pos) return -1;"
  text "${text}")
file(WRITE ${HEADER} "${text}")
