// Files and folders that are whole or not there.
#include "app/write_file.h"

#include "engine/core/error.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

namespace rend {

std::string plain_name(const std::string& name, const std::string& otherwise) {
  std::string plain = name.substr(0, 40);
  for (char& c : plain)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
  return plain.empty() ? otherwise : plain;
}

void write_file(const std::filesystem::path& file, const std::string& bytes) {
  const std::filesystem::path temporary = file.string() + ".tmp";
  const auto refuse = [&](const char* what) {
    const int code = errno;
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw Error(file.string(), fmt::format("cannot {}: {}", what, std::strerror(code)));
  };
  std::FILE* out = std::fopen(temporary.c_str(), "wb");
  if (!out) refuse("create the file");
  const bool written =
      std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size() && std::fflush(out) == 0;
  if (std::fclose(out) != 0 || !written) refuse("write the file");
  if (std::rename(temporary.c_str(), file.c_str()) != 0) refuse("rename the finished file");
}

void check_folder(const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::path there = std::filesystem::absolute(folder);
  while (!std::filesystem::exists(there, code) && there.has_relative_path())
    there = there.parent_path();
  if (!std::filesystem::is_directory(there, code))
    throw Error(folder.string(), fmt::format("cannot be a folder: {} is a file", there.string()));
  if (access(there.c_str(), W_OK | X_OK) != 0)
    throw Error(folder.string(),
                fmt::format("cannot be written: {}: {}", there.string(), std::strerror(errno)));
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) throw Error(folder.string(), "cannot create the folder: " + code.message());
}

}  // namespace rend
