// Fills a scene from JSON through the field tables and refuses everything they do not allow.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/scene/field_visitor.h"
#include "engine/scene/json_value.h"

namespace rend {

/// Where a scene's text came from and where its mesh files may lie, in order.
struct SceneSource {
  std::string name;
  std::vector<std::filesystem::path> folders;
};

/// Reads one JSON object; finish() must follow the last field.
class FieldReader : public FieldVisitor {
 public:
  /// `absent` stands for an object that the scene leaves out. @throws Error when `json` is no
  /// object.
  FieldReader(const JsonValue& json, std::string pointer, const SceneSource& source,
              bool absent = false);

  /// @throws Error for a key that no field asked for, then for one that is missing.
  void finish() const;

  void number(const Field&, Real& value, const Range&) override;
  void optional_number(const Field&, std::optional<Real>& value, const Range&) override;
  void number_or_word(const Field&, std::optional<Real>& value, const char* word,
                      const Range&) override;
  void integer(const Field&, std::int64_t& value, std::int64_t min, std::int64_t max,
               std::span<const std::int64_t> allowed) override;
  void flag(const Field&, bool& value) override;
  void text(const Field&, std::string& value, std::size_t max_length) override;
  void choice(const Field&, int& value, Names names) override;
  void vector(const Field&, Vec3& value, const Range&) override;
  void matrix(const Field&, Mat3& value, const Range&) override;
  void points(const Field&, std::vector<Eigen::Vector2d>& value, std::size_t min, std::size_t max,
              const Range&) override;
  void reference(const Field&, std::size_t& value, std::span<const std::string> names) override;
  void mesh_file(const Field&, std::string& file, std::string& path) override;
  void object(const Field&, const std::function<void(FieldVisitor&)>& fields) override;
  void sequence(const Field&, const Sequence& sequence) override;
  void variant(const Field&, int& value, Names names,
               const std::function<void(FieldVisitor&, int)>& fields) override;
  bool fills() const override { return true; }
  bool given(const char* key) const override { return json_.find(key) != nullptr; }
  void exclusive(const char* first, const char* second) override;

 private:
  const JsonValue* take(const Field& field, const char* unit = nullptr);
  std::string place(std::string_view key) const;
  Real read_number(const JsonValue& value, const std::string& place, const Range& range,
                   const char* word = nullptr) const;
  const JsonValue& read_list(const JsonValue& value, const std::string& place, std::size_t min,
                             std::size_t max, const std::string& what) const;
  std::size_t read_name(const JsonValue& value, const std::string& place, const char* what,
                        const std::vector<std::string>& names) const;

  const JsonValue& json_;
  std::string pointer_;
  const SceneSource& source_;
  bool absent_;
  std::vector<std::string> known_;
  std::string missing_;
};

/// The entry of `names` that takes the fewest edits from `name`; empty when none is near.
std::string nearest_name(const std::string& name, const std::vector<std::string>& names);

/// The first `folder / file` that is a regular file. @throws Error(place) that says where it
/// looked.
std::string find_mesh_file(const std::string& file,
                           const std::vector<std::filesystem::path>& folders,
                           const std::string& place);

}  // namespace rend
