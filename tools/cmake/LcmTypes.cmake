# clearway_lcm_types(target PACKAGE name FILES a.lcm ...): C++ bindings of LCM types as an
# INTERFACE library; headers are included as <name/a.hpp>. The same rule serves LCM with and
# without a CMake package: it needs only the lcm-gen program.

if(TARGET lcm::lcm-gen)
  set(LCM_GEN_PROGRAM $<TARGET_FILE:lcm::lcm-gen>)
else()
  find_program(LCM_GEN_PROGRAM lcm-gen REQUIRED)
endif()

set(CLEARWAY_HARDEN_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/HardenLcmTypes.cmake)

function(clearway_lcm_types target)
  cmake_parse_arguments(ARG "" "PACKAGE" "FILES" ${ARGN})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/generated)
  set(headers)
  foreach(file ${ARG_FILES})
    cmake_path(GET file STEM type)
    set(header ${out}/${ARG_PACKAGE}/${type}.hpp)
    add_custom_command(OUTPUT ${header}
      COMMAND ${LCM_GEN_PROGRAM} -x --cpp-std c++11 --cpp-hpath ${out}
              ${CMAKE_CURRENT_SOURCE_DIR}/${file}
      COMMAND ${CMAKE_COMMAND} -D HEADER=${header} -P ${CLEARWAY_HARDEN_SCRIPT}
      DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${file} ${CLEARWAY_HARDEN_SCRIPT}
      COMMENT "lcm-gen ${file}" VERBATIM)
    list(APPEND headers ${header})
  endforeach()
  add_custom_target(${target}_generate DEPENDS ${headers})
  add_library(${target} INTERFACE)
  add_dependencies(${target} ${target}_generate)
  # SYSTEM: generated code is clean under -Wall -Wextra only.
  target_include_directories(${target} SYSTEM INTERFACE ${out})
  target_link_libraries(${target} INTERFACE lcm::library)
endfunction()
