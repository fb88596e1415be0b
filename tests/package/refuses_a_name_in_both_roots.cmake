# Configures a copy of the project as it is, which must succeed, and with one surface header named like an engine
# header, which must fail and name it. Nothing is built.
# Needs SOURCE, WORK, GENERATOR, COMPILER.

function(configure_copy result_variable output_variable)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -S ${WORK}/source -B ${WORK}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
            -DDARBOUX_BUILD_TOOL=OFF -DDARBOUX_BUILD_TESTS=OFF
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(${result_variable} ${result} PARENT_SCOPE)
  # CMake folds long messages; undo that.
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  set(${output_variable} "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
file(COPY ${SOURCE}/CMakeLists.txt ${SOURCE}/LICENSE ${SOURCE}/include ${SOURCE}/surfaces ${SOURCE}/src
     DESTINATION ${WORK}/source)

configure_copy(result output)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "the untouched copy does not configure, so a refusal would prove nothing:\n${output}")
endif()

file(WRITE ${WORK}/source/surfaces/darboux/frame.h "#pragma once\n")
configure_copy(result output)
if(result EQUAL 0)
  message(FATAL_ERROR "darboux/frame.h in both include/ and surfaces/ was accepted")
endif()
if(NOT output MATCHES "darboux/frame.h exists in both include/ and surfaces/")
  message(FATAL_ERROR "refused for another reason:\n${output}")
endif()
file(REMOVE_RECURSE ${WORK})
