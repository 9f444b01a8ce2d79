# Shared build rules: one library a folder, the same warnings and sanitizers everywhere.
include_guard()

add_library(rend_flags INTERFACE)
target_include_directories(rend_flags INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/generated)
target_compile_options(rend_flags INTERFACE -Wall -Wextra -Wno-unknown-pragmas -fno-math-errno
  # g++ 12 warns of overlapping copies inside std::string where there are none (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
target_compile_definitions(rend_flags INTERFACE REND_VERSION="${PROJECT_VERSION}")
if(REND_SANITIZE)
  target_compile_options(rend_flags INTERFACE -fsanitize=${REND_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(rend_flags INTERFACE -fsanitize=${REND_SANITIZE})
endif()

# rend_library(name LINK ...): a static library of all sources directly in the calling folder, or in SUBDIR.
function(rend_library name)
  cmake_parse_arguments(ARG "" "SUBDIR" "LINK" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_SUBDIR}/*.cpp)
  if(sources)
    add_library(${name} STATIC ${sources})
    target_link_libraries(${name} PUBLIC rend_flags ${ARG_LINK})
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE rend_flags ${ARG_LINK})
  endif()
endfunction()

# rend_test(folder LINK ...): one doctest program test_<folder> of tests/<folder>/*.cpp, with the caller's time_limit [s].
function(rend_test folder)
  cmake_parse_arguments(ARG "" "" "LINK" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${folder} ${sources})
  target_link_libraries(test_${folder} PRIVATE rend_flags doctest::doctest rend_doctest_main ${ARG_LINK})
  target_compile_definitions(test_${folder} PRIVATE REND_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  add_test(NAME ${folder} COMMAND test_${folder})
  set_tests_properties(${folder} PROPERTIES TIMEOUT ${time_limit})
endfunction()
