// Turns a scene into JSON through the field tables.
#pragma once

#include "engine/scene/field_visitor.h"
#include "engine/scene/json_value.h"

namespace rend {

/// Adds every field that it visits to one JSON object.
class FieldWriter : public FieldVisitor {
 public:
  explicit FieldWriter(JsonValue& object) : json_(object) {}

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
  bool fills() const override { return false; }

 private:
  void put(const Field& field, JsonValue value);

  JsonValue& json_;
};

}  // namespace rend
