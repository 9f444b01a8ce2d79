# Fails when docs/coverage.md lacks a row of the slides or names a file that does not exist.
# Run: cmake -DROOT=<repository> -P tests/check_coverage.cmake
cmake_policy(VERSION 3.25)

file(READ ${ROOT}/docs/coverage.md text)
set(missing "")

string(REGEX MATCHALL "`[a-z_]+/[A-Za-z0-9_./-]+\\.[a-z]+`" quoted "${text}")
list(LENGTH quoted count)
if(count LESS 60)
  list(APPEND missing "only ${count} files are named")
endif()
foreach(name ${quoted})
  string(REPLACE "`" "" name ${name})
  if(NOT EXISTS ${ROOT}/${name})
    list(APPEND missing "${name} does not exist")
  endif()
endforeach()

foreach(n RANGE 1 16)
  list(APPEND rows M${n})
endforeach()
list(APPEND rows V0 V1 V2 V3 E1 E2 E3 E4 E5 E6 E7 E8 E9 E10 E11a E11b E12 C1 C2 L1 L2 L3)
foreach(row ${rows})
  if(NOT text MATCHES "\n\\| ([A-Z0-9a-z]+, )?${row}(, [A-Z0-9]+)? \\| [^\n]*`tests/")
    list(APPEND missing "row ${row} is missing or names no test")
  endif()
endforeach()

if(missing)
  list(JOIN missing "\n  " lines)
  message(FATAL_ERROR "docs/coverage.md:\n  ${lines}")
endif()
