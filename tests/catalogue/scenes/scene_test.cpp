#include "catalogue/scenes/scene.hpp"

#include <array>
#include <map>

#include <fmt/format.h>

#include "catalogue/models/tissue_problem.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "tests/catalogue/scenes/scene_files.hpp"
#include "tests/growth_of_time.hpp"

namespace hmax {
namespace {

/// A bar of 3 cubes of 10 mm, six tetrahedra each, in mm, t, s and MPa.
constexpr const char* beam_input =
    "*HEADING\nanything, at all\n** a remark\n*node, nset=NALL\n"
    "1,0,0,0\n2,0,0,10\n3,0,10,0\n4,0,10,10\n5,10,0,0\n6,10,0,10\n7,10,10,0\n8,10,10,10\n"
    "9,20,0,0\n10,20,0,10\n11,20,10,0\n12,20,10,10\n13,30,0,0\n14,30,0,10\n15,30,10,0\n16,3.0D1,10,10\n"
    "*ELEMENT, TYPE=C3D4,\nELSET=EALL\n"
    "1,1,5,7,8\n2,1,6,5,8\n3,1,7,3,8\n4,1,3,4,8\n5,1,2,6,8\n6,1,4,2,8\n7,5,9,11,12\n8,5,10,9,12\n"
    "9,5,11,7,12\n10,5,7,8,12\n11,5,6,10,12\n12,5,8,6,12\n13,9,13,15,16\n14,9,14,13,16\n15,9,15,11,16\n"
    "16,9,11,12,16\n17,9,10,14,16\n18,9,12,10,16\n"
    "*NSET, NSET=FIX, GENERATE\n1,4,1\n";
constexpr const char* material = "*MATERIAL, NAME=Steel\n*ELASTIC\n210000., 0.3\n*DENSITY\n7.8e-9\n";
constexpr const char* section = "*SOLID SECTION, ELSET=EALL, MATERIAL=STEEL\n";
constexpr const char* boundary = "*BOUNDARY\nFIX, 1, 3\n";
constexpr const char* step =
    "*STEP\n*DYNAMIC, ALPHA=-0.1, DIRECT\n1e-5, 1e-3\n*DLOAD\nEALL, GRAV, 9810., 0., 0., -2.\n*END STEP\n";

class Scenes : public SceneFiles {
 protected:
  Scenes()
      : SceneFiles("bar.inp", "mm,t,s", std::string(beam_input) + material + section + boundary + step) {}
};

/// Tetrahedra side by side whose points have a force each, no two the same.
std::string with_forces(int tetrahedra) {
  std::string points = "*NODE\n", elements = "*ELEMENT,TYPE=C3D4,ELSET=EALL\n",
              forces = "*STEP\n*DYNAMIC\n1,1\n*CLOAD\n";
  for (int i = 0; i < tetrahedra; ++i) {
    const int first = 4 * i + 1;
    for (int corner = 0; corner < 4; ++corner) {
      points += fmt::format("{},{},{},{}\n", first + corner, 2 * i + (corner == 1), corner == 2 ? 1 : 0,
                            corner == 3 ? 1 : 0);
      forces += fmt::format("{},3,{}\n", first + corner, 1e-3 * (first + corner));
    }
    elements += fmt::format("{},{},{},{},{}\n", i + 1, first, first + 1, first + 2, first + 3);
  }
  return points + elements + material + section + "*BOUNDARY\n1,1,3\n" + forces + "*END STEP\n";
}

TEST_F(Scenes, OfManyForcesAreReadInProportionToThem) {
  const auto load = [&](int n) {
    EXPECT_EQ(body(read(with_forces(n)))->settings().forces.size(), static_cast<std::size_t>(4 * n));
  };
  EXPECT_LT(growth_of_time(load, 1000), 8);
}

TEST_F(Scenes, ConvertUnitsOfAllNumbers) {
  const Scene scene = read(changed("*SOLID", "*DAMPING, ALPHA=3, BETA=2e-6\n*SOLID"));
  EXPECT_EQ(scene.model, "fem_cauchy");
  EXPECT_EQ(scene.method, "hht_alpha:alpha=-0.1");
  EXPECT_DOUBLE_EQ(scene.step.value(), 1e-5);
  EXPECT_DOUBLE_EQ(scene.settings.unit.value(), 1e-3);
  std::map<std::string, double> values(scene.settings.parameters.begin(), scene.settings.parameters.end());
  EXPECT_DOUBLE_EQ(values.at("E"), 2.1e11);
  EXPECT_DOUBLE_EQ(values.at("nu"), 0.3);
  EXPECT_NEAR(values.at("rho"), 7800, 1e-9);
  EXPECT_DOUBLE_EQ(values.at("gz"), -9.81);  // the direction has no length
  EXPECT_DOUBLE_EQ(values.at("alpha"), 3);
  EXPECT_DOUBLE_EQ(values.at("beta"), 2e-6);
  const Scene in_ms = read_in("mm,kg,ms", whole);
  values = {in_ms.settings.parameters.begin(), in_ms.settings.parameters.end()};
  EXPECT_DOUBLE_EQ(values.at("E"), 2.1e14);
  EXPECT_DOUBLE_EQ(in_ms.step.value(), 1e-8);
}

/// The displacements of a static analysis of this file by CalculiX 2.20, [mm].
TEST_F(Scenes, SagsAsInCalculix) {
  const auto made = body(read(whole));
  const Eigen::Index n = made->dofs();
  ASSERT_EQ(n, 36);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd force(n);
  TissueBody::DofMatrix K;
  made->force(0, zero, zero, force);
  made->stiffness(0, zero, zero, K);
  const Eigen::VectorXd q = Eigen::MatrixXd(K).ldlt().solve(force);
  const Eigen::Matrix3Xd moved = made->positions(0, q) - made->mesh().points;
  const std::map<std::int64_t, Eigen::Vector3d> calculix{{5, {-1.228750E-07, 5.692150E-08, -4.259729E-07}},
                                                         {12, {1.404333E-07, 1.308763E-07, -8.898200E-07}},
                                                         {13, {-1.752967E-07, 2.787703E-07, -1.405198E-06}},
                                                         {16, {1.426665E-07, 2.558028E-07, -1.386151E-06}}};
  std::size_t found = 0;
  for (Eigen::Index i = 0; i < made->mesh().point_count(); ++i)
    if (const auto its = calculix.find(made->origin()->point_number(i)); its != calculix.end()) {
      ++found;
      EXPECT_LT((1e3 * moved.col(i) - its->second).norm(), 1e-6 * its->second.norm()) << its->first;
    }
  EXPECT_EQ(found, 4U);
}

TEST_F(Scenes, TakeTheModelAndTheIntegratorOfTheStep) {
  const Scene large = read(changed("*STEP\n", "*STEP, NLGEOM\n"));
  EXPECT_EQ(large.model, "fem_green");
  EXPECT_TRUE(says(large.notes.front(), "as in CalculiX; Abaqus differs"));
  EXPECT_EQ(read(changed("*STEP\n", "*STEP, NLGEOM=NO\n")).model, "fem_cauchy");
  EXPECT_EQ(read(changed("ALPHA=-0.1, DIRECT", "EXPLICIT")).method, "symplectic_euler");
  for (const char* kind : {"2", "3"})
    EXPECT_EQ(read(changed("ALPHA=-0.1, DIRECT", std::string("EXPLICIT=") + kind)).method,
              "symplectic_euler");
  for (const char* kind : {"0", "1"})
    EXPECT_EQ(read(changed("DIRECT", std::string("EXPLICIT=") + kind)).method, "hht_alpha:alpha=-0.1");
  EXPECT_EQ(read(changed(", ALPHA=-0.1, DIRECT", "")).method, "hht_alpha:alpha=-0.05");
  EXPECT_EQ(read(changed("*DYNAMIC, ALPHA=-0.1, DIRECT", "*STATIC")).method, "");
  EXPECT_FALSE(read(changed("1e-5, 1e-3\n", "")).step);
}

TEST_F(Scenes, HaveAMaterialInEachSection) {
  const std::string two =
      std::string(beam_input) +
      "*ELSET, ELSET=END\n13,14,15,\n16,17,18\n*ELSET, ELSET=REST, GENERATE\n1,12\n" + material +
      "*MATERIAL, NAME=SOFT\n*ELASTIC\n100., 0.2\n*DENSITY\n1e-9\n" +
      "*SOLID SECTION, ELSET=REST, MATERIAL=STEEL\n*SOLID SECTION, ELSET=END, MATERIAL=SOFT\n" + boundary;
  const auto made = body(read(two));
  ASSERT_EQ(made->settings().materials.size(), 2U);
  double mass = 0;
  for (Eigen::Index i = 0; i < made->dofs(); i += 3) mass += made->mass()[i];
  // A quarter of each tetrahedron at the held points is not in it: 6 of the 12 of the first cube's corners.
  EXPECT_GT(mass, 7800 * 1e-6);
  EXPECT_LT(mass, 7800 * 2e-6 + 1000 * 1e-6);
  EXPECT_TRUE(says(error(replaced(two, "13,14,15,", "12,13,14,15,")), "has a *SOLID SECTION already"));
  EXPECT_TRUE(says(error(replaced(two, "\n1,12\n", "\n1,11\n")), "1 elements are in no *SOLID SECTION"));
  for (const auto& [what, by, named] : {std::array{"100., 0.2", "100., 0.5", "Poisson's ratio is 0.5"},
                                        {"\n1e-9", "\n-1e-9", "density is -1000"}})
    EXPECT_TRUE(says(error_of<InputError>([&] { body(read(replaced(two, what, by))); }), named));
}

TEST_F(Scenes, CollectDirectionsOfHeldPoints) {
  const auto held = [&](const std::string& lines) {
    return body(read(changed("FIX, 1, 3\n", lines)))->dofs();
  };
  EXPECT_EQ(held("FIX, 1\nFIX, 2, 2\nFIX, 3, 6, 0.\n"), 36);
  EXPECT_EQ(held("FIX, ENCASTRE\n5, 1, 3\n"), 33);
  for (const char* other :
       {"FIX, 1, 2\n", "FIX, XSYMM\n", "FIX, 1, 3, 0.1\n", "FIX, 1, 3\n16, 2\n", "FIX, 11\n"})
    EXPECT_TRUE(says(error(changed("FIX, 1, 3\n", other)), "--ignore 'BOUNDARY'")) << other;
  const Scene freed = read(changed("FIX, 1, 3\n", "FIX, 1, 3\n16, 2\n"), "boundary");
  EXPECT_EQ(body(freed)->dofs(), 36);
  for (const auto& [lines, dofs] :
       {std::pair("FIX, 1, 3\nFIX, 1, 1, 0.1\n", 36), {"FIX, 1, 3\nFIX, 11\n", 36}}) {
    const std::string twice = replaced(whole, "FIX, 1, 3\n", lines);
    EXPECT_TRUE(says(error(twice), "--ignore 'BOUNDARY'"));
    EXPECT_EQ(body(read(twice, "BOUNDARY"))->dofs(), dofs);
  }
  EXPECT_EQ(body(read(replaced(whole, "*BOUNDARY", "*BOUNDARY, TYPE=VELOCITY"), "BOUNDARY"))->dofs(), 48);
  EXPECT_EQ(body(read(replaced(whole, "*BOUNDARY", "*BOUNDARY, TYPE=DISPLACEMENT")))->dofs(), 36);
  EXPECT_EQ(held("FIX, XSYMM\nFIX, YSYMM\nFIX, ZSYMM\n"), 36);
  ASSERT_EQ(freed.notes.size(), 2U);
  EXPECT_TRUE(says(freed.notes.back(), "BOUNDARY"));
  EXPECT_EQ(body(read(std::string(beam_input) + material + section))->dofs(), 48);
}

TEST_F(Scenes, NameWhatTheyDoNotUnderstand) {
  const auto refused = [&](const std::string& what, const std::string& by, const std::string& named) {
    const std::string told = error(changed(what, by));
    EXPECT_TRUE(says(told, named));
    EXPECT_TRUE(says(told, "bar.inp")) << named;
    EXPECT_EQ(told.find('\n'), std::string::npos);
  };
  refused("*STEP\n", "*CONTACT PAIR, INTERACTION=A\nB,C\n*STEP\n",
          "line 51: *CONTACT PAIR is not understood");
  refused("*DLOAD", "*CLOAD\n16,4,1.\n*DLOAD", "line 55: *CLOAD is along direction 4");
  refused("*DLOAD", "*CLOAD\n17,3,1.\n*DLOAD", "there is no node 17");
  refused("*DLOAD", "*CLOAD\nTIP,3,1.\n*DLOAD", "no node set 'TIP'");
  refused("*DLOAD", "*CLOAD\nFIX,3\n*DLOAD", "has no force");
  refused("*DLOAD", "*DLOAD, AMPLITUDE=UP", "no *AMPLITUDE 'UP'");
  refused("EALL, GRAV, 9810.", "EALL, P1, 9810.", "*DLOAD is not GRAV");
  refused("EALL, GRAV, 9810.", "SOME, GRAV, 9810.", "'SOME', which is not the whole body");
  refused("TYPE=C3D4", "TYPE=C3D8", "only C3D4 and C3D10 are read");
  refused("MATERIAL=STEEL", "MATERIAL=WOOD", "no material 'WOOD'");
  refused("ELSET=EALL, M", "ELSET=EVERY, M", "no element set 'EVERY'");
  refused("*BOUNDARY\nFIX", "*BOUNDARY\nFIXED", "no node set 'FIXED'");
  refused("1,4,1\n", "1,1000000000,1\n", "needs node 17");
  refused("1,4,1\n", "1,4,0\n", "step of a set is 0");
  refused("1,1,5,7,8\n", "1,1,5,7,1000000000\n", "needs node 1000000000");
  refused("1,1,5,7,8\n", "1,1,5,7\n", "has no node of an element");
  refused("2,1,6,5,8\n", "1,1,6,5,8\n", "element 1 is given twice");
  refused("2,0,0,10\n", "2,0,0,1O\n", "'1O'");
  refused("2,0,0,10\n", "2,0,0,10 1\n", "one value between two commas");
  refused("*DENSITY\n7.8e-9\n", "", "has no *DENSITY");
  refused("*ELASTIC\n", "*ELASTIC, TYPE=ORTHO\n", "only isotropic solids");
  refused("*BOUNDARY\n", "*BOUNDARY, OP=NEW\n", "OP of *BOUNDARY");
  refused("*END STEP\n", "*END STEP\n*STEP\n", "a second *STEP");
  refused("*END STEP\n", "", "no *END STEP");
  refused("*END STEP\n", "*END ST", "the last line has no end");
  refused("1e-5, 1e-3", "0, 1e-3", "time increment is 0");
  refused("ALPHA=-0.1", "ALPHA=0.1", "between -1/3 and 0");
  refused("DIRECT", "EXPLICIT", "ALPHA of *DYNAMIC, EXPLICIT is not understood");
  refused("ALPHA=-0.1, DIRECT", "EXPLICIT=4", "EXPLICIT=4 of *DYNAMIC");
  refused("ALPHA=-0.1, DIRECT\n1e-5, 1e-3", "EXPLICIT\n1e-5, 1e-3, 1e-6", "scales masses");
  refused("*HEADING", "1,2\n*HEADING", "begins with a keyword");
  refused("*NSET", "*INCLUDE, INPUT=a.inc\n*NSET", "a.inc' to include");
  refused("*NSET", "*INCLUDE\n*NSET", "names no file");
  refused("*NSET", "*INCLUDE, INPUT=bar.inp\n*NSET", "without end");
  refused("*BOUNDARY\nFIX", "*BOUNDARY\n", "names no node and no set");
}

/// Lines of values go on in the included file, and behind it.
TEST_F(Scenes, IncludeOtherFiles) {
  const std::string lines = "9,20,0,0\n10,20,0,10\n";
  write_text(folder / "Nodes.dat", lines);
  write_text(folder / "steel.inc", material);
  const Eigen::Matrix3Xd points = body(read(whole))->mesh().points;
  const std::string split =
      replaced(changed(lines, "*INCLUDE, INPUT=Nodes.dat\n"), material, "*Include, input = \"steel.inc\"\n");
  EXPECT_EQ(body(read(split))->mesh().points, points);
  EXPECT_EQ(value(read(split), "E"), 2.1e11);
  write_text(folder / "Nodes.dat", "9,20,0,0\n10,20,0,1O\n");
  EXPECT_TRUE(says(error(split), "Nodes.dat, line 2"));
  write_text(folder / "Nodes.dat", "9,20,0,0\n10,20,0,1");
  EXPECT_TRUE(says(error(split), "Nodes.dat, line 2: the last line has no end"));
  write_text(folder / "Nodes.dat", lines);
  // Behind an included file lines count on as before.
  EXPECT_TRUE(says(error(replaced(split, "11,20,10,0", "11,20,10,O")), "bar.inp, line 14"));
  EXPECT_EQ(error(split), "");
  EXPECT_TRUE(read_mesh_file(folder / "bar.inp").where(0).ends_with("/bar.inp, line 22: tetrahedron 1"));
}

TEST_F(Scenes, EndWithoutALineBreakWhereNothingCanBeMissing) {
  EXPECT_EQ(read(whole.substr(0, whole.size() - 1)).step, 1e-5);
  EXPECT_TRUE(says(error(whole + "*SURFACE, NAME=A\nEALL"), "the last line has no end"));
}

TEST_F(Scenes, BeginWithTheMarkOfUtf8) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(read(mark + whole).step, 1e-5);
  write_text(folder / "steel.inc", mark + material);
  EXPECT_EQ(value(read(mark + changed(material, "*INCLUDE, INPUT=steel.inc\n")), "E"), 2.1e11);
}

TEST_F(Scenes, HaveElementsThatGoOnBehindAComma) {
  const TetMesh::Tetrahedra corners = body(read(whole))->mesh().tetrahedra;
  const auto with = [&](const char* element) {
    return body(read(changed("\n2,1,6,5,8\n", element)))->mesh().tetrahedra;
  };
  EXPECT_EQ(with("\n2,1,6,\n5,8\n"), corners);
  EXPECT_EQ(with("\n2,\n1,6,\n5,\n8\n"), corners);
  EXPECT_EQ(with("\n2,1,6,5,8,\n"), corners);
  EXPECT_TRUE(says(error(changed("\n2,1,6,5,8\n", "\n2,1,6,\n")), "more than four nodes"));
}

/// What Abaqus/CAE writes: sets of the part and of the assembly may have the same name.
TEST_F(Scenes, HaveOnePartInOneInstance) {
  const std::string part = std::string("*Heading\n*Part, name=Bar\n") + std::string(beam_input).substr(9) +
                           section +
                           "*End Part\n*Assembly, name=All\n*Instance, name=Bar-1, part=Bar\n*End Instance\n"
                           "*Nset, nset=FIX, instance=Bar-1\n1,2,3,4,16\n*End Assembly\n";
  const std::string assembly = part + material + boundary + replaced(step, "EALL, GRAV", ", GRAV");
  EXPECT_EQ(body(read(assembly))->dofs(), 33);
  EXPECT_DOUBLE_EQ(value(read(assembly), "gz"), -9.81);
  EXPECT_EQ(body(read(replaced(assembly, "FIX, 1, 3", "Bar-1.FIX, 1, 3")))->dofs(), 36);
  EXPECT_EQ(body(read(replaced(assembly, "FIX, 1, 3", "Bar-1.FIX, 1, 3\nBar-1.13, 1, 3")))->dofs(), 33);
  EXPECT_EQ(body(read(replaced(assembly, "part=Bar\n", "part=Bar\n0.,0.,0.\n")))->dofs(), 33);
  for (const auto& [what, by, named] :
       {std::array{"part=Bar\n", "part=Bar\n0.,0.,1.\n", "the *INSTANCE is moved"},
        {"part=Bar\n", "part=Rod\n", "not of the *PART"},
        {"*End Instance\n", "*End Instance\n*Instance, name=Bar-2, part=Bar\n*End Instance\n",
         "a second *INSTANCE"},
        {"*Assembly", "*Part, name=B\n*End Part\n*Assembly", "a second *PART"},
        {"instance=Bar-1\n", "instance=Bar-2\n", "no *INSTANCE 'BAR-2'"},
        {"*Instance, name=Bar-1, part=Bar\n*End Instance\n", "", "no *INSTANCE"},
        {"*End Instance\n", "", "has no end"}})
    EXPECT_TRUE(says(error(replaced(assembly, what, by)), named));
}

/// Moduli in SI units, so that a force of 2 N is 2 t mm/s^2.
TEST_F(Scenes, HaveForcesOnPointsAndConstantAmplitudes) {
  const std::string loaded =
      changed("*DLOAD",
              "*AMPLITUDE, NAME=HALF\n0, 0.5, 1, 0.5\n*CLOAD\n16,3,-2.\nFIX,1,1.\n16,3,1.\n"
              "*CLOAD, AMPLITUDE=HALF\n15,2,4.\n*DLOAD, AMPLITUDE=HALF");
  const Scene scene = read(loaded);
  EXPECT_EQ(value(scene, "force_z:points:16"), -1);
  EXPECT_EQ(value(scene, "force_y:points:15"), 2);
  EXPECT_EQ(value(scene, "force_x:points:1,2,3,4"), 1);
  EXPECT_DOUBLE_EQ(value(scene, "gz"), -4.905);
  EXPECT_EQ(value(read_in("m,t,s", loaded), "force_y:points:15"), 2000);
  const auto made = body(scene);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(made->dofs());
  Eigen::VectorXd force = zero;
  made->force(0, zero, zero, force);
  double y = 0, z = 0;
  for (Eigen::Index i = 0; i < made->dofs(); i += 3) {
    y += force[i + 1];
    z += force[i + 2];
  }
  EXPECT_NEAR(y, 2, 1e-12);
  EXPECT_NEAR(z, -1 - 4.905 * Eigen::VectorXd(made->mass()).sum() / 3, 1e-12);

  const std::string ramp = replaced(loaded, "0, 0.5, 1, 0.5", "0, 0., 1, 0.5");
  EXPECT_TRUE(says(error(ramp), "*CLOAD follows the amplitude HALF of line 54, which changes with time"));
  EXPECT_EQ(value(read(ramp, "AMPLITUDE"), "force_y:points:15"), 4);
  EXPECT_TRUE(
      says(error(replaced(loaded, "NAME=HALF\n", "NAME=HALF, DEFINITION=PERIODIC\n")), "changes with time"));
}

TEST_F(Scenes, SayWhereNumbersOutOfRangeStand) {
  const Scene scene = read(changed("210000., 0.3", "210000., 0.5"));
  const auto told = [&](Parameters parameters, const std::string& set) {
    leave_out(scene, parameters, set);
    return error_of<InputError>([&] { require_in_range(scene, parameters); });
  };
  EXPECT_TRUE(says(told(scene.settings.parameters, "E"), "bar.inp, line 45: Poisson's ratio is 0.5"));
  EXPECT_EQ(told(scene.settings.parameters, "nu"), "");
}

TEST_F(Scenes, LeaveOutWhatIsIgnored) {
  const std::string loaded = changed("*DLOAD", "*CLOAD\n16,4,1.\n*DLOAD");
  const Scene scene = read(loaded, "*cload");
  EXPECT_TRUE(says(scene.notes.back(), "CLOAD"));
  EXPECT_TRUE(says(error(whole, "CLOAD"), "nothing of it to leave out"));
  EXPECT_TRUE(says(error(loaded, "CLOAD,"), "empty part"));
}

TEST_F(Scenes, LeaveNothingOfTheMeshOut) {
  for (const auto& [what, by, part] :
       {std::array{"nset=NALL", "nset=NALL, system=C", "NODE"},
        {"*SOLID SECTION, ", "*SOLID SECTION, ORIENTATION=A, ", "SOLID SECTION"}})
    EXPECT_TRUE(says(error(replaced(whole, what, by), part), " of *" + std::string(part) + " is not "));
  const std::string thrice =
      replaced(whole, "*DLOAD", "*AMPLITUDE, NAME=A, UNKNOWN\n0, 3.\n*DLOAD, AMPLITUDE=A");
  EXPECT_DOUBLE_EQ(value(read(thrice, "AMPLITUDE"), "gz"), -9.81);
}

TEST_F(Scenes, NeedThreeUnits) {
  for (const auto& [units, named] : std::map<std::string, std::string>{{"", "does not say its units"},
                                                                       {"mm", "is not enough"},
                                                                       {"mm,t,s,K", "is not enough"},
                                                                       {"mm,lb,s", "no unit of mass"},
                                                                       {"mm,t,0", "no unit of time"},
                                                                       {"ft,t,s", "no unit of length"}})
    EXPECT_TRUE(says(error_of<InputError>([&] { read_in(units, whole); }), named));
  for (const auto& [file, named] :
       {std::pair("a.txt", "no scene by its extension"), {"a.fmu", "`hmax probe FILE`"}})
    EXPECT_TRUE(says(error_of<InputError>([&] { read_scene(file, "m,kg,s", ""); }), named));
}

/// Wherever a file is cut off, it is refused or read, and never more than that.
TEST_F(Scenes, SurviveCuts) {
  const auto cut = [&](std::size_t size) { return std::array{whole.substr(0, size)}; };
  EXPECT_GT(refused(whole, 7, cut), whole.size() / 7 - 10);
}

}  // namespace
}  // namespace hmax
