#include <set>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

TEST(List, MethodsHaveTheKeysOfTheContract) {
  const AnyJson methods = Shell().json("list methods");
  ASSERT_GE(methods.size(), 13U);
  std::set<std::string> ids;
  for (const AnyJson& method : methods) {
    expect_keys(method, {"id", "aliases", "family", "order", "error_order", "stages", "explicit", "adaptive",
                         "needs_jacobian", "a_stable", "l_stable", "engine", "source", "note",
                         "linearly_implicit", "first_same_as_last", "steps_back"});
    if (method.at("id") == "adams_bashforth_4") {
      EXPECT_EQ(method.at("steps_back"), 3);
    }
    if (method.at("id") == "fehlberg_78") {
      EXPECT_TRUE(says(method.at("note").get<std::string>(), "error estimate is zero"));
    }
    ids.insert(method.at("id"));
    EXPECT_EQ(method.at("adaptive"), method.at("error_order") > 0);
  }
  EXPECT_TRUE(ids.contains("dop_853") && ids.contains("rk4"));
  EXPECT_EQ(ids.size(), methods.size());
}

TEST(List, ProblemsHaveTheKeysOfTheContract) {
  const AnyJson problems = Shell().json("list problems");
  ASSERT_EQ(problems.size(), 16U);
  for (const AnyJson& problem : problems)
    expect_keys(problem, {"id", "dimension", "parameters", "y0", "t_end", "has_exact_solution"});
  // The numbers of the published full model.
  EXPECT_EQ(problems[2].at("id"), "liver_forced");
  EXPECT_EQ(problems[2].at("y0"), AnyJson({0.5, 1.0}));
  EXPECT_EQ(problems[2].at("parameters").at("m"), 1.45);
}

TEST(List, ModelsHaveTheKeysOfTheContract) {
  const AnyJson models = Shell().json("list models");
  ASSERT_EQ(models.size(), 7U);
  for (const AnyJson& model : models)
    expect_keys(model, {"id", "note", "is_linear", "is_of_springs", "resists_inversion", "resists_locking"});
  EXPECT_EQ(models[0].at("id"), "fem_green") << "the default comes first";
}

TEST(List, MaterialsHaveTheKeysOfTheContract) {
  const AnyJson materials = Shell().json("list materials");
  ASSERT_EQ(materials.size(), 6U + 17U);
  for (const AnyJson& material : materials) expect_keys(material, {"id", "parameters", "source"});
  EXPECT_EQ(materials.at(6).at("parameters").at("E"), 5500);
}

TEST(List, AsksWhatToListWhenNothingIsNamed) {
  const Shell shell;
  expect_refused(
      shell.hmax("list"),
      "say what to list, methods, problems, models or materials; for instance `hmax list methods`");
  expect_refused(shell.hmax("list method"), "did you mean 'methods'?");
}

TEST(List, TablesForPeopleNameEverything) {
  const Shell shell;
  for (const char* what : {"methods", "problems", "models", "materials"}) {
    const std::string table = shell.hmax(std::string("list ") + what).out;
    for (const AnyJson& entry : shell.json(std::string("list ") + what))
      EXPECT_TRUE(says(table, entry.at("id").get<std::string>())) << entry.at("id");
    EXPECT_EQ(table.find('\x1b'), std::string::npos) << "colour in a file";
  }
}

}  // namespace
}  // namespace hmax
