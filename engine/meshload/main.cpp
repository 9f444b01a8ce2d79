// rend-meshload ENDING CPU_SECONDS MEMORY_BYTES: a mesh file on stdin becomes flat triangles on
// stdout. A process of its own, because damaged files crash or hang the importer.
#include "engine/mesh/mesh_stream.h"
#include "engine/meshload/sandbox.h"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <unistd.h>

#include <assimp/Importer.hpp>
#include <cstdlib>
#include <new>
#include <string>
#include <vector>

namespace rend {

namespace {

using Bytes = std::vector<std::uint8_t>;

// Knows one file only, so that neither material libraries nor external buffers are looked for.
class OneFile final : public Assimp::IOSystem {
 public:
  OneFile(std::string name, const Bytes& bytes) : name_(std::move(name)), bytes_(bytes) {}
  bool Exists(const char* file) const override { return file == name_; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char*) override {
    return Exists(file) ? new Assimp::MemoryIOStream(bytes_.data(), bytes_.size()) : nullptr;
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  std::string name_;
  const Bytes& bytes_;
};

bool read_all(Bytes& bytes) {
  std::vector<std::uint8_t> chunk(1 << 20);
  ssize_t n;
  while ((n = read(STDIN_FILENO, chunk.data(), chunk.size())) > 0)
    bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + n);
  return n == 0;
}

bool write_all(const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = write(STDOUT_FILENO, at, size);
    if (n <= 0) return false;
    at += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

int fail(const std::string& reason) {
  const MeshStreamHeader header{mesh_stream_magic, 1, 0, reason.size()};
  write_all(&header, sizeof header);
  write_all(reason.data(), reason.size());
  return 1;
}

int send(const aiScene& scene) {
  std::vector<float> positions;
  std::vector<std::uint32_t> triangles;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    const auto first = static_cast<std::uint32_t>(positions.size() / 3);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v)
      for (unsigned k = 0; k < 3; ++k) positions.push_back(mesh.mVertices[v][k]);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f)
      if (const aiFace& face = mesh.mFaces[f]; face.mNumIndices == 3)
        for (unsigned k = 0; k < 3; ++k) triangles.push_back(first + face.mIndices[k]);
  }
  if (triangles.empty()) return fail("it holds no triangles");
  const MeshStreamHeader header{mesh_stream_magic, 0, positions.size() / 3, triangles.size() / 3};
  const bool sent = write_all(&header, sizeof header) &&
                    write_all(positions.data(), positions.size() * sizeof positions[0]) &&
                    write_all(triangles.data(), triangles.size() * sizeof triangles[0]);
  return sent ? 0 : 1;
}

int load(const std::string& ending, const Bytes& bytes) {
  const std::string name = "mesh." + ending;
  Assimp::Importer importer;
  importer.SetIOHandler(new OneFile(name, bytes));
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                  aiComponent_COLORS | aiComponent_TEXCOORDS |
                                  aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                  aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS);
  const aiScene* scene =
      importer.ReadFile(name, aiProcess_RemoveComponent | aiProcess_Triangulate |
                                  aiProcess_PreTransformVertices | aiProcess_SortByPType);
  return scene ? send(*scene) : fail(importer.GetErrorString());
}

}  // namespace

}  // namespace rend

int main(int argc, char** argv) {
  using namespace rend;
  int code = 1;
  try {
    Bytes bytes;
    if (argc != 4)
      code = fail("usage: rend-meshload ENDING CPU_SECONDS MEMORY_BYTES < FILE");
    else if (!limit_resources({std::strtoull(argv[3], nullptr, 10),
                               unsigned(std::strtoul(argv[2], nullptr, 10))}) ||
             !read_all(bytes) || !enter_sandbox())
      code = fail("the mesh loader could not shut itself in");
    else
      code = load(argv[1], bytes);
  } catch (const std::bad_alloc&) {
    code = fail("reading it takes too much memory");
  } catch (const std::exception& e) {
    code = fail(e.what());
  }
  // Destructors and exit handlers have nothing to do here, and some would ask for forbidden calls.
  _exit(code);
}
