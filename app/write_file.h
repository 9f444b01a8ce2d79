// Files and folders that are whole or not there.
#pragma once

#include <filesystem>
#include <string>

namespace rend {

/// `name` with letters, digits, '-' and '_' only, forty at most, so that it serves as file name and
/// in an address; `otherwise` when nothing is left.
std::string plain_name(const std::string& name, const std::string& otherwise);

/// Writes bytes under a temporary name and renames. @throws Error naming the file when the disk
/// refuses.
void write_file(const std::filesystem::path& file, const std::string& bytes);

/// Changes nothing. @throws Error naming what is in the way when make_folder() or a file in the
/// folder would be refused.
void check_folder(const std::filesystem::path& folder);

/// Makes a folder and those above it. @throws Error naming the folder when the disk refuses.
void make_folder(const std::filesystem::path& folder);

}  // namespace rend
