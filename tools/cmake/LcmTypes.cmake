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
    set_property(GLOBAL APPEND PROPERTY CLEARWAY_LCM_FILES ${CMAKE_CURRENT_SOURCE_DIR}/${file})
    set_property(GLOBAL APPEND PROPERTY CLEARWAY_LCM_TYPES ${ARG_PACKAGE}/${type})
  endforeach()
  add_custom_target(${target}_generate DEPENDS ${headers})
  add_library(${target} INTERFACE)
  add_dependencies(${target} ${target}_generate)
  # SYSTEM: generated code is clean under -Wall -Wextra only.
  target_include_directories(${target} SYSTEM INTERFACE ${out})
  target_link_libraries(${target} INTERFACE lcm::library)
endfunction()

# clearway_types_jar(): Java bindings of all types so far in one jar; with it lcm-spy decodes
# messages. Target types_jar, part of the ordinary build where a JDK and LCM's jar are.
function(clearway_types_jar)
  find_program(JAVAC_PROGRAM javac)
  find_program(JAR_PROGRAM jar)
  find_file(LCM_JAR lcm.jar PATHS /usr/share/java /usr/local/share/java)
  if(NOT JAVAC_PROGRAM OR NOT JAR_PROGRAM OR NOT LCM_JAR)
    message(STATUS "types_jar (for lcm-spy) is left out: it needs javac, jar and lcm.jar, in "
                   "Debian's default-jdk-headless and liblcm-java")
    return()
  endif()
  get_property(files GLOBAL PROPERTY CLEARWAY_LCM_FILES)
  get_property(types GLOBAL PROPERTY CLEARWAY_LCM_TYPES)
  set(sources ${types})
  list(TRANSFORM sources APPEND .java)
  set(work ${CMAKE_CURRENT_BINARY_DIR}/java)
  set(folder ${PROJECT_BINARY_DIR}/share/java)
  set(jar ${folder}/clearway-types.jar)
  # Java 8 is what Debian's lcm.jar is compiled for. The folder is emptied so that no type outlives
  # its removal.
  add_custom_command(OUTPUT ${jar}
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${work}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${work}/classes ${folder}
    COMMAND ${LCM_GEN_PROGRAM} -j --jpath ${work} ${files}
    COMMAND ${CMAKE_COMMAND} -E chdir ${work}
            ${JAVAC_PROGRAM} --release 8 -Xlint:-options -cp ${LCM_JAR} -d classes ${sources}
    COMMAND ${JAR_PROGRAM} cf ${jar} -C ${work}/classes .
    DEPENDS ${files} COMMENT "clearway-types.jar" VERBATIM)
  add_custom_target(types_jar ALL DEPENDS ${jar})
  install(FILES ${jar} DESTINATION ${CMAKE_INSTALL_DATADIR}/java)
endfunction()
