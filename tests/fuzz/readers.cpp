// The readers of users' files under libFuzzer: each gives what a file holds or refuses it in one sentence.
//   fuzz_readers --seeds=FOLDER                      writes small files of most formats there, and lists the
//   readers fuzz_readers --reader=NAME [option of libFuzzer | corpus...]
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "catalogue/input/toml_file.hpp"
#include "catalogue/methods/tableau_file.hpp"
#include "catalogue/models/problem_file.hpp"
#include "catalogue/scenes/scene_builder.hpp"
#include "core/errors.hpp"
#include "problems/formula_system.hpp"
#include "problems/matrices/read_matrix.hpp"
#include "problems/mesh/files/mesh_defects.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "tests/problems/matrices/matrix_samples.hpp"
#include "tests/problems/mesh/files/mesh_goldens.hpp"

namespace hmax {
namespace {

void use(MeshFile file) {
  if (defects_of(file.mesh).none()) import_mesh(file, 1);
}

void mesh(const std::string& name, std::string_view bytes) { use(read_mesh(name, bytes)); }

/// Both files of TetGen, one behind the other.
constexpr char between_files = '\f';
void tetgen(const std::string& /*name*/, std::string_view bytes) {
  const std::size_t end = std::min(bytes.find(between_files), bytes.size());
  use(read_tetgen("a.node", bytes.substr(0, end), "a.ele", bytes.substr(std::min(end + 1, bytes.size()))));
}

void matrix(const std::string& name, std::string_view bytes) {
  constexpr Eigen::Index many = 1000;
  const MatrixFile file = matrix_from(name, bytes);
  if (file.rows < many && file.columns < many) assembled(file, file.rows, file.columns);
}

template <auto read_part>
void scene(const std::string& name, std::string_view bytes) {
  SceneBuilder builder("mm,t,s", "");
  read_part(name, bytes, builder);
  builder.finish(name);
}

void toml(const std::string& name, std::string_view bytes) { parse_toml(bytes, name); }
void tableau(const std::string& name, std::string_view bytes) { tableau_from(parse_toml(bytes, name)); }

void problem(const std::string& name, std::string_view bytes) {
  const FormulaDefinition definition = problem_from(parse_toml(bytes, name));
  const FormulaSystem system(definition);
  const Eigen::Index dim = system.dim();
  Eigen::MatrixXd slopes(dim, dim);
  system.jacobian(definition.t0, Eigen::VectorXd::Zero(dim), slopes);
}

struct Reader {
  std::string_view name;
  std::string file;  ///< as it is called in messages; its extension may tell the format
  void (*read)(const std::string& file, std::string_view bytes);
};
const std::array<Reader, 19> readers{{{"gmsh", "a.msh", mesh},
                                      {"vtk", "a.vtk", mesh},
                                      {"vtu", "a.vtu", mesh},
                                      {"medit", "a.mesh", mesh},
                                      {"vega", "a.veg", mesh},
                                      {"tetgen", "a.node", tetgen},
                                      {"inp", "a.inp", mesh},
                                      {"sofa", "a.scn", mesh},
                                      {"febio", "a.feb", mesh},
                                      {"mujoco", "a.xml", mesh},
                                      {"inp_scene", "a.inp", scene<read_inp_scene>},
                                      {"sofa_scene", "a.scn", scene<read_sofa_scene>},
                                      {"febio_scene", "a.feb", scene<read_febio_scene>},
                                      {"mujoco_scene", "a.xml", scene<read_mujoco_scene>},
                                      {"matrix", "a.mtx", matrix},
                                      {"calculix", "a.sti", matrix},
                                      {"toml", "a.toml", toml},
                                      {"tableau", "a.toml", tableau},
                                      {"problem", "a.toml", problem}}};

void write_seeds(const std::filesystem::path& folder) {
  const auto write = [&](const std::string& name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
  };
  for (const GoldenMesh& golden : golden_meshes())
    write(golden.name, golden.ele_name.empty() ? golden.text : golden.text + between_files + golden.ele_text);
  for (const MatrixSample& sample : matrix_samples()) write(sample.name, sample.bytes);
}

const Reader* chosen = nullptr;

[[noreturn]] void finding(const std::string& text) {
  std::cerr << "FINDING: " << text << '\n';
  std::abort();
}

}  // namespace
}  // namespace hmax

extern "C" int LLVMFuzzerInitialize(int* count, char*** words) {
  constexpr std::string_view seeds = "--seeds=", reader = "--reader=";
  for (int i = 1; i < *count; ++i) {
    const std::string_view word = (*words)[i];
    if (word.starts_with(seeds)) hmax::write_seeds(word.substr(seeds.size()));
    for (const hmax::Reader& each : hmax::readers)
      if (word.starts_with(reader) && word.substr(reader.size()) == each.name) hmax::chosen = &each;
  }
  if (hmax::chosen != nullptr) return 0;
  for (const hmax::Reader& each : hmax::readers) std::cout << each.name << '\n';
  std::exit(EXIT_SUCCESS);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  std::string refusal = "-";
  try {
    hmax::chosen->read(hmax::chosen->file, {reinterpret_cast<const char*>(bytes), size});
  } catch (const std::invalid_argument& error) {
    refusal = error.what();
  } catch (const hmax::InputError& error) {
    refusal = error.what();
  }  // any other exception ends the program
  if (refusal.empty() || refusal.find('\n') != std::string::npos)
    hmax::finding("a refusal is no sentence of one line: '" + refusal + "'");
  return 0;
}
