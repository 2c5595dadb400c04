/// Models of matrices that were damaged anywhere, through constraint rows, Lagrange multipliers, condensation
/// and series: every one is refused in a sentence, or a model of finite numbers.

#include "tests/problems/matrices/matrix_folder.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

class DamagedModels : public MatrixFolder {
 protected:
  DamagedModels() {
    // A penalty row, a row of its own, a point without mass, two multipliers that hold and tie, two masses.
    stiffness_ =
        "%%MatrixMarket matrix coordinate real symmetric\n8 8 11\n1 1 1e9\n2 1 -1\n2 2 7\n3 3 1\n4 2 -2\n4 4 4\n"
        "5 4 -2\n5 5 9\n7 5 1\n7 6 -1\n8 6 2\n";
    mass_ = "%%MatrixMarket matrix array real general\n8 1\n1\n1\n1\n0\n1\n2\n0\n0\n";
    damping_ = "%%MatrixMarket matrix coordinate real general\n8 8 4\n1 1 0.1\n2 2 0.2\n2 5 0.1\n5 2 -0.1\n";
    series_ = "0 K.mtx\n0.5 K.mtx\n2 K.mtx\n";
    restore();
  }
  void restore() const {
    write("K.mtx", stiffness_);
    write("M.mtx", mass_);
    write("C.mtx", damping_);
    write("K.txt", series_);
  }
  /// Checks the model, whatever is in the files.
  void look(bool series, bool drop) const {
    const MatrixFiles files{.stiffness = (scratch_ / (series ? "K.txt" : "K.mtx")).string(),
                            .mass = (scratch_ / "M.mtx").string(),
                            .damping = (scratch_ / "C.mtx").string(),
                            .stiffness_series = series,
                            .drop_constraints = drop};
    try {
      const MatrixModel model = read_matrix_model(files);
      const AnySystem system = system_of(model, 0.1, 0.01);
      ASSERT_EQ(system.dim(), 2 * model.size());
      ASSERT_EQ(model.start.size(), 2 * model.size());
      EXPECT_GT(system.mass().minCoeff(), 0);
      VectorXd rates = model.start;
      system.rhs(0.7, VectorXd::Zero(system.dim()), rates);
      EXPECT_TRUE(rates.allFinite());
    } catch (const std::invalid_argument& error) {
      const std::string sentence = error.what();
      EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
      EXPECT_TRUE(says(sentence, "; "));
    }
  }
  void look_at_all() const {
    look(false, false);
    look(false, true);
    look(true, false);
  }
  /// Damages one file by `change` at every place of its text.
  template <class Change>
  void damage(const std::string& name, const std::string& text, const Change& change) const {
    for (std::size_t i = 0; i < text.size(); ++i) {
      std::string damaged = text;
      change(damaged, i);
      write(name, damaged);
      look_at_all();
    }
    restore();
  }

  std::string stiffness_, mass_, damping_, series_;
};

TEST_F(DamagedModels, TheWholeOneHasAllKindsOfRows) {
  const MatrixModel model = read_matrix_model({.stiffness = (scratch_ / "K.mtx").string(),
                                               .mass = (scratch_ / "M.mtx").string(),
                                               .drop_constraints = true});
  EXPECT_EQ(model.facts.constraints.penalties.size(), 1U);
  EXPECT_EQ(model.facts.constraints.decoupled.size(), 1U);
  EXPECT_EQ(model.facts.multipliers, 2);
  EXPECT_EQ(model.facts.massless, 1);
  EXPECT_EQ(model.size(), 1);
}

TEST_F(DamagedModels, WithAWrongByteAnywhereAreRefusedOrFinite) {
  for (const char byte : {'0', '9', '-', '\n', 'e'})
    for (const auto& [name, text] :
         {std::pair("K.mtx", stiffness_), {"M.mtx", mass_}, {"C.mtx", damping_}, {"K.txt", series_}})
      damage(name, text, [byte](std::string& damaged, std::size_t i) { damaged[i] = byte; });
}

TEST_F(DamagedModels, WithWordsPutInOrCutOffAreRefusedOrFinite) {
  for (const auto& [name, text] :
       {std::pair("K.mtx", stiffness_), {"M.mtx", mass_}, {"C.mtx", damping_}, {"K.txt", series_}}) {
    for (const char* words : {"1e300", " nan ", "-1 ", "99999999"})
      damage(name, text, [words](std::string& damaged, std::size_t i) { damaged.insert(i, words); });
    damage(name, text, [](std::string& damaged, std::size_t i) { damaged.resize(i); });
  }
}

}  // namespace
}  // namespace hmax
