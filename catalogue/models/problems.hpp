/// Every problem by name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "problems/formula_system.hpp"

namespace hmax {

/// What the name of a problem stands for.
enum class ProblemKind {
  listed,    ///< one of problem_ids()
  formulas,  ///< a file of them, FILE.toml
  body,      ///< tissue on a mesh, MODEL@MESH (tissue_problem.hpp)
  matrices,  ///< of a user (matrix_problem.hpp)
  plugin     ///< (catalogue/plugin/plugin_model.hpp)
};

/// By the name alone: no file is looked at, and nothing of the name needs to exist.
ProblemKind problem_kind(std::string_view id_or_file);

/// Ids of the problems of the catalogue, in the order in which they are listed.
std::vector<std::string> problem_ids();

/// A problem by id, by the path of a TOML file of formulas (a name that ends in .toml), or tissue on a mesh,
/// MODEL@MESH (catalogue/models/tissue_problem.hpp).
/// @throws InputError  for an unknown name, material or parameter (with a suggestion), a wrong number of
/// initial
///                     values, numbers that are not finite, or a file that is no problem
Problem make_problem(const std::string& id_or_file, const ProblemSettings& settings = {});

/// Formulas at hand.
/// @param file  where they stand, for messages
/// @throws InputError  as above
Problem make_problem(const FormulaDefinition& definition, const std::string& file,
                     const ProblemSettings& settings = {});

}  // namespace hmax
