# Targets of clearway: one warning interface, one helper for each kind of target.

add_library(clearway_options INTERFACE)
target_compile_options(clearway_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor -Woverloaded-virtual
  # GCC 12 warns inside its own std::string when optimising (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  # The same result on x86-64 and aarch64: no fused multiply-add behind the source's back.
  -ffp-contract=off
  $<$<BOOL:${CLEARWAY_WERROR}>:-Werror>)
target_include_directories(clearway_options INTERFACE ${PROJECT_SOURCE_DIR})
# A process links what it uses, not what its libraries could use.
target_link_options(clearway_options INTERFACE -Wl,--as-needed)
if(CLEARWAY_SANITIZE)
  target_compile_options(clearway_options INTERFACE
    -fsanitize=${CLEARWAY_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all -g1)
  target_link_options(clearway_options INTERFACE -fsanitize=${CLEARWAY_SANITIZE})
endif()

if(CLEARWAY_FUZZERS)
  target_compile_options(clearway_options INTERFACE -fsanitize=fuzzer-no-link)
  target_link_options(clearway_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

# clearway_library(name SOURCES ... [PUBLIC libs...] [PRIVATE libs...]): target clearway::name.
function(clearway_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(clearway_${name} STATIC ${ARG_SOURCES})
  add_library(clearway::${name} ALIAS clearway_${name})
  target_link_libraries(clearway_${name} PUBLIC clearway_options ${ARG_PUBLIC}
                        PRIVATE ${ARG_PRIVATE})
endfunction()

# clearway_program(name SOURCES ... LINK libs...): program clearway-name, installed.
function(clearway_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  string(REPLACE "-" "_" target ${name})
  add_executable(clearway_${target}_program ${ARG_SOURCES})
  set_target_properties(clearway_${target}_program PROPERTIES OUTPUT_NAME clearway-${name})
  target_link_libraries(clearway_${target}_program PRIVATE clearway_options ${ARG_LINK})
  add_dependencies(programs clearway_${target}_program)
  install(TARGETS clearway_${target}_program DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()
add_custom_target(programs)

# What nearly every test includes, compiled once; preset dev does without, so that no test leans on
# what others include. Tests themselves are hardly optimised, with sanitizers not at all: what they
# test is. Optimised ones do without the header, whose flags they do not share.
function(clearway_test_options name optimised)
  # One set of flags for all: some libraries bring -pthread along, which a header's must match.
  # GCC 12 at -O1 sees bounds overrun inside its own std::string (as in GCC bug 105651).
  set(flags -pthread $<$<CONFIG:Release>:-O1>
      $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds -Wno-stringop-overflow>)
  if(CLEARWAY_SANITIZE AND optimised)
    target_compile_options(${name} PRIVATE -pthread -O1)
    return()
  elseif(CLEARWAY_SANITIZE)
    list(APPEND flags -O0)
  endif()
  target_compile_options(${name} PRIVATE ${flags})
  if(NOT CLEARWAY_TEST_PCH)
    return()
  endif()
  if(NOT TARGET clearway_test_pch)
    file(WRITE ${PROJECT_BINARY_DIR}/test_pch.cpp "// Holds the tests' precompiled header.\n")
    add_library(clearway_test_pch OBJECT ${PROJECT_BINARY_DIR}/test_pch.cpp)
    target_link_libraries(clearway_test_pch PRIVATE clearway_options Eigen3::Eigen GTest::gmock)
    target_compile_options(clearway_test_pch PRIVATE ${flags})
    target_precompile_headers(clearway_test_pch PRIVATE
      <algorithm> <filesystem> <fstream> <functional> <map> <memory> <optional> <random> <sstream>
      <string> <vector> <Eigen/Geometry> <gmock/gmock.h> <gtest/gtest.h>)
  endif()
  target_precompile_headers(${name} REUSE_FROM clearway_test_pch)
endfunction()

# clearway_test(name [NETWORK] [COMPUTES] SOURCES ... LINK libs... [TIMEOUT s] [LABELS ...]): one
# gtest program, one CTest entry. NETWORK runs it in a network namespace of its own, where multicast
# goes over loopback. COMPUTES optimises it with sanitizers too, for the sake of its own loops.
function(clearway_test name)
  cmake_parse_arguments(ARG "NETWORK;COMPUTES" "TIMEOUT" "SOURCES;LINK;LABELS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE clearway_options ${ARG_LINK} GTest::gmock GTest::gtest_main)
  clearway_test_options(${name} ${ARG_COMPUTES})
  set_target_properties(${name} PROPERTIES
                        RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  if(ARG_NETWORK)
    add_test(NAME ${name} COMMAND ${PROJECT_SOURCE_DIR}/tools/in_namespace $<TARGET_FILE:${name}>)
  else()
    add_test(NAME ${name} COMMAND ${name})
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 400)  # Sanitizers on a busy machine; a hang is all that this is for.
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}"
    PROCESSORS 2  # Halves: see tests/CMakeLists.txt.
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    ENVIRONMENT "CLEARWAY_BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY};CLEARWAY_SOURCE=${PROJECT_SOURCE_DIR}")
endfunction()

# clearway_fuzzer(name SOURCES ... LINK libs...): one libFuzzer program and a short CTest run over
# its corpus in tests/data/fuzz/<name>, whose new inputs go to the build folder.
function(clearway_fuzzer name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  if(NOT CLEARWAY_FUZZERS)
    return()
  endif()
  add_executable(fuzz_${name} ${ARG_SOURCES})
  target_link_libraries(fuzz_${name} PRIVATE clearway_options ${ARG_LINK})
  target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/fuzz/${name})
  add_test(NAME fuzz_${name} COMMAND fuzz_${name} -max_total_time=4 -rss_limit_mb=2048
           ${PROJECT_BINARY_DIR}/fuzz/${name} ${PROJECT_SOURCE_DIR}/tests/data/fuzz/${name})
  set_tests_properties(fuzz_${name} PROPERTIES TIMEOUT 120 LABELS fuzz PROCESSORS 2)
endfunction()
