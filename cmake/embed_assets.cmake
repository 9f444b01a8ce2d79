# Turns the files of a folder into one C++ source with their bytes.
# As include: embed_assets(target folder). As script: -DFOLDER= -DOUTPUT= -DFILES=a|b -P.

if(CMAKE_SCRIPT_MODE_FILE)
  set(types
    html "text/html; charset=utf-8"
    css "text/css; charset=utf-8"
    js "text/javascript; charset=utf-8"
    mjs "text/javascript; charset=utf-8"
    json "application/json"
    svg "image/svg+xml"
    png "image/png"
    jpg "image/jpeg"
    ico "image/x-icon"
    woff2 "font/woff2"
    txt "text/plain; charset=utf-8")
  string(REPLACE "|" ";" FILES "${FILES}")
  set(arrays "")
  set(table "")
  set(number 0)
  foreach(file IN LISTS FILES)
    file(READ "${FOLDER}/${file}" bytes HEX)
    file(SHA256 "${FOLDER}/${file}" hash)
    file(SIZE "${FOLDER}/${file}" size)
    string(SUBSTRING "${hash}" 0 20 hash)
    string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
    cmake_path(GET file EXTENSION LAST_ONLY ending)
    string(REPLACE "." "" ending "${ending}")
    list(FIND types "${ending}" at)
    if(at EQUAL -1)
      set(type "application/octet-stream")
    else()
      math(EXPR at "${at} + 1")
      list(GET types ${at} type)
    endif()
    string(APPEND arrays "const unsigned char file_${number}[] = {${bytes}0};\n")
    string(APPEND table "      {\"/${file}\", \"${type}\", text(file_${number}, ${size}), \"\\\"${hash}\\\"\"},\n")
    math(EXPR number "${number} + 1")
  endforeach()
  file(WRITE "${OUTPUT}" "// Generated from web/page; do not edit.
#include <cstddef>
#include <vector>

#include \"web/assets.h\"

namespace rend::web {
namespace {

${arrays}
[[maybe_unused]] std::string_view text(const unsigned char* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace

std::span<const Asset> page_assets() {
  static const std::vector<Asset> table = {
${table}  };
  return table;
}

}  // namespace rend::web
")
  return()
endif()

set(REND_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

# embed_assets(target folder): adds the source with every file of `folder` to `target`; package files, tests,
# notes and node_modules stay out.
function(embed_assets target folder)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE ${folder} ${folder}/*)
  list(FILTER files EXCLUDE REGEX "(^|/)(node_modules|tests?)/|(^|/)(package(-lock)?\\.json|[^/]*\\.(md|test\\.m?js)|\\..*)$")
  list(SORT files)
  list(TRANSFORM files PREPEND ${folder}/ OUTPUT_VARIABLE inputs)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/page_assets.cpp)
  string(REPLACE ";" "|" listed "${files}")
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${folder} -DOUTPUT=${output} "-DFILES=${listed}" -P ${REND_EMBED_SCRIPT}
    DEPENDS ${inputs} ${REND_EMBED_SCRIPT}
    COMMENT "Embedding the page" VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()
