# Fails when two headers define different types under one name: each file alone compiles, but the linker keeps one
# constructor or destructor for both (the one definition rule), and only unoptimised builds show it.
# Run: cmake -DROOT=<repository> -P cmake/check_names.cmake
cmake_policy(VERSION 3.25)

set(bad 0)
file(GLOB_RECURSE files RELATIVE "${ROOT}" "${ROOT}/engine/*.h" "${ROOT}/render/*.h" "${ROOT}/web/*.h" "${ROOT}/app/*.h"
     "${ROOT}/bench/*.h")
foreach(file IN LISTS files)
  file(STRINGS "${ROOT}/${file}" scope LIMIT_COUNT 1 REGEX "^namespace ")
  file(STRINGS "${ROOT}/${file}" lines REGEX "^(struct|class) [A-Za-z0-9_]+( final)?( :| {)")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^(struct|class) ([A-Za-z0-9_]+).*" "\\2" name "${line}")
    string(MAKE_C_IDENTIFIER "${scope}_${name}" key)
    if(DEFINED first_${key})
      message("${file}: ${name} is defined in ${first_${key}} too")
      math(EXPR bad "${bad}+1")
    endif()
    set(first_${key} "${file}")
  endforeach()
endforeach()
if(bad GREATER 0)
  message(FATAL_ERROR "${bad} names with two meanings")
endif()
