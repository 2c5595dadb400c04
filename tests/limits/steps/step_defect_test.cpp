/// Wrong coefficients in every method: what moves no limit is seen by the steps themselves.
#include "limits/steps/step_defect.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/amplification/one_step_amplification.hpp"
#include "analysis/amplification/stabilised_amplification.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/implicit/dirk_tableaux.hpp"
#include "integrators/implicit/imex_tableaux.hpp"
#include "integrators/implicit/radau_coefficients.hpp"
#include "integrators/implicit/rosenbrock_tableaux.hpp"
#include "limits/predict.hpp"
#include "limits/verification.hpp"
#include "tests/limits/planted_tableau.hpp"

namespace hmax {
namespace {

constexpr long double planted = 1e-6L;

TEST(StepDefect, IsRoundingForEveryMethodOfTheCatalogue) {
  for (const Method& method : methods())
    EXPECT_LE(step_defect(method), method.engine == "hmax" ? 1e-12 : rounding_of_steps) << method.id;
}

/// The amplification of a method that claims what it is not.
Method with(const Method& method, Amplification claimed) {
  Method other = method;
  other.amplification = shared(std::move(claimed));
  return other;
}

/// What was planted into one method.
struct Planted {
  std::string id;
  int noticed = 0, unread = 0;
};

/// Every number of `numbers` that is not zero a millionth larger: the steps must notice, if they read it.
template <class Remake>
void plant(
    Planted& count, std::vector<long double*> numbers, const Method& method, const Remake& remake,
    const std::function<bool(std::size_t)>& is_read = [](std::size_t) { return true; }) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (*numbers[i] == 0) continue;
    const long double right = *numbers[i];
    *numbers[i] *= 1 + planted;
    const double defect = step_defect(with(method, remake()));
    *numbers[i] = right;
    EXPECT_EQ(defect > rounding_of_steps, is_read(i)) << method.id << " number " << i << ": " << defect;
    (is_read(i) ? count.noticed : count.unread) += 1;
  }
}

/// Without those that should be zero, but for the digits that the coefficients behind them have.
std::vector<long double*> beyond_rounding(std::vector<long double*> numbers) {
  long double largest = 0;
  for (const long double* number : numbers) largest = std::max(largest, std::abs(*number));
  std::erase_if(numbers, [&](const long double* number) { return std::abs(*number) <= 1e-4L * largest; });
  return numbers;
}

template <class Numbers>
std::vector<long double*> all_of(Numbers& numbers) {
  std::vector<long double*> all;
  for (auto& each : numbers)
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(each)>, long double>)
      all.push_back(&each);
    else
      for (long double* inner : all_of(each)) all.push_back(inner);
  return all;
}

std::vector<long double*> joined(std::initializer_list<std::vector<long double*>> parts) {
  std::vector<long double*> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

template <class T>
Planted in_tableau() {
  const Method method = find_method(T::id);
  Planted count{.id = method.id};
  auto t = T::tableau;
  const std::vector<bool> used = stages_used(at_run_time<T>());
  const std::size_t s = used.size();
  plant(
      count, joined({all_of(t.b), all_of(t.a)}), method,
      [&] { return runge_kutta_amplification(detail::flattened(t.a), t.b, T::order); },
      [&](std::size_t i) { return used[i < s ? i : (i - s) / s]; });
  return count;
}

template <class T>
Planted in_rosenbrock() {
  const Method method = find_method(T::id);
  Planted count{.id = method.id};
  auto t = T::tableau;
  // A stage of which only the error estimate is made is not read by a step.
  const std::size_t s = t.m.size();
  std::vector<bool> used(s);
  for (std::size_t i = s; i-- > 0;) {
    used[i] = t.m[i] != 0;
    for (std::size_t later = i + 1; later < s; ++later)
      used[i] = used[i] || (used[later] && (t.a[later][i] != 0 || t.c[later][i] != 0));
  }
  plant(
      count, joined({all_of(t.m), all_of(t.a), all_of(t.c), {&t.gamma}}), method,
      [&] { return rosenbrock_amplification(t, T::order); },
      [&](std::size_t i) { return used[i < s ? i : (i - s) / s % s] || i == s + 2 * s * s; });
  return count;
}

template <class T>
Planted in_pair() {
  const Method method = find_method(T::id);
  Planted count{.id = method.id};
  auto t = T::tableau;
  plant(count, joined({all_of(t.nonstiff.a), all_of(t.nonstiff.b), all_of(t.stiff.a), all_of(t.stiff.b)}),
        method, [&] { return additive_amplification(t, T::order); });
  return count;
}

Planted in_radau() {
  const Method method = find_method("radau_iia_5");
  Planted count{.id = method.id};
  auto t = radau::tableau;
  plant(count, joined({all_of(t.a), all_of(t.b)}), method,
        [&] { return full_runge_kutta_amplification(detail::flattened(t.a), t.b, 5); });
  return count;
}

std::vector<Polynomial> in_real_numbers(const StepPolynomial& polynomial) {
  std::vector<Polynomial> p;
  for (const ComplexPolynomial& each : polynomial.coefficients()) {
    p.emplace_back();
    for (const LongComplex c : each) p.back().push_back(c.real());
  }
  return p;
}

/// Into the coefficients of the recurrence.
Planted in_multistep(const Method& method) {
  Planted count{.id = method.id};
  std::vector<Polynomial> p = in_real_numbers(*method.amplification->in_z);
  plant(count, all_of(p), method, [&] {
    Amplification wrong = *method.amplification;
    wrong.in_z = StepPolynomial::real(p);
    wrong.of_eigenmode = [of = *wrong.in_z](const Eigenmode& mode) {
      return Growth{.polynomial = of.along(mode.lambda)};
    };
    return wrong;
  });
  return count;
}

Planted in_motion(const Method& method) {
  Planted count{.id = method.id};
  MotionMap map = *method.amplification->motion;
  const std::vector<long double*> numbers =
      joined({all_of(map.inertia), all_of(map.damper), all_of(map.lumped), all_of(map.spring)});
  const auto remake = [&] {
    Amplification wrong = *method.amplification;
    wrong.motion = map;
    return wrong;
  };
  plant(count, beyond_rounding(numbers), method, remake);
  return count;
}

template <class Polynomials>
Planted in_stages() {
  const Method method = find_method(Polynomials::id);
  Planted count{.id = method.id};
  // So many stages do the modes take by which steps are looked at.
  for (const int s : {Polynomials::template stages<double>(0.5), Polynomials::template stages<double>(3.0)}) {
    detail::StabilisedStages stages;
    make_stages<Polynomials>(s, stages);
    for (std::size_t j = 0; j < stages.size(); ++j)
      for (double StabilizedStage<double>::*number :
           {&StabilizedStage<double>::mu, &StabilizedStage<double>::nu, &StabilizedStage<double>::rest,
            &StabilizedStage<double>::mu_f, &StabilizedStage<double>::gamma_f}) {
        if (stages[j].*number == 0 || (j == 0 && number != &StabilizedStage<double>::mu_f)) continue;
        detail::StabilisedStages wrong = stages;
        wrong[j].*number *= 1 + static_cast<double>(planted);
        Amplification claimed = *method.amplification;
        claimed.of_eigenmode = [=, right = method.amplification->of_eigenmode](const Eigenmode& mode) {
          if (Polynomials::template stages<double>(mode.radius) != s) return right(mode);
          Growth growth;
          growth.radius = [=](double h) { return std::abs(detail::stabilised_step(wrong, h * mode.lambda)); };
          return growth;
        };
        EXPECT_GT(step_defect(with(method, claimed)), rounding_of_steps) << method.id << " " << s << " " << j;
        ++count.noticed;
      }
  }
  return count;
}

/// Of foreign tables into what they come to, R(z).
Planted in_rational_function(const Method& method) {
  Planted count{.id = method.id};
  std::vector<Polynomial> p = in_real_numbers(*method.amplification->in_z);
  const auto remake = [&] {
    Amplification wrong = *method.amplification;
    wrong.of_eigenmode = [of = StepPolynomial::real(p)](const Eigenmode& mode) {
      return Growth{.polynomial = of.along(mode.lambda)};
    };
    return wrong;
  };
  plant(count, beyond_rounding(all_of(p)), method, remake);
  return count;
}

TEST(StepDefect, ShowsAMillionthInAnyCoefficientThatAStepOfAnyMethodReads) {
  std::vector<Planted> all;
  const auto each_of = [&]<class... T>(std::type_identity<std::tuple<T...>>, const auto& work) {
    (all.push_back(work(std::type_identity<T>{})), ...);
  };
  each_of(std::type_identity<tableaux::All>{},
          []<class T>(std::type_identity<T>) { return in_tableau<T>(); });
  each_of(std::type_identity<tableaux::AllDiagonallyImplicit>{},
          []<class T>(std::type_identity<T>) { return in_tableau<T>(); });
  each_of(std::type_identity<tableaux::AllRosenbrock>{},
          []<class T>(std::type_identity<T>) { return in_rosenbrock<T>(); });
  each_of(std::type_identity<tableaux::AllImex>{},
          []<class T>(std::type_identity<T>) { return in_pair<T>(); });
  all.push_back(in_radau());
  all.push_back(in_stages<Rkc2>());
  all.push_back(in_stages<Rkl2>());
  for (const Method& method : methods()) {
    if (!method.amplification) continue;
    if (method.family == "adams") all.push_back(in_multistep(method));
    if (method.amplification->motion) all.push_back(in_motion(method));
  }
  // What brings no coefficients of its own here: foreign tables, further families.
  const auto is_planted = [&](const Method& method) {
    return std::ranges::find(all, method.id, &Planted::id) != all.end();
  };
  for (const Method& method : methods())
    if (method.amplification && method.amplification->R && !method.needs_split && !is_planted(method))
      all.push_back(in_rational_function(method));
  std::set<std::string> planted_into;
  int noticed = 0, unread = 0;
  for (const Planted& each : all) {
    EXPECT_GT(each.noticed, 0) << each.id;
    planted_into.insert(each.id);
    noticed += each.noticed;
    unread += each.unread;
  }
  for (const Method& method : methods())
    if (!method.is_foreign() && method.amplification && !method.amplification->measured) {
      EXPECT_TRUE(planted_into.contains(method.id)) << method.id;
    }
  RecordProperty("noticed", noticed);
  RecordProperty("unread", unread);
  EXPECT_GT(noticed, 500);  // 788 with SUNDIALS
}

// ---- and where the code is wrong, not the claim

template <class T>
void expect_wrong_code_is_noticed() {
  const Method claimed = find_method(T::id);
  RuntimeTableau code = at_run_time<T>();
  const std::vector<bool> used = stages_used(code);
  const std::size_t s = used.size();
  const auto defect = [&] { return step_defect(with(planted_method(code), *claimed.amplification)); };
  EXPECT_LE(defect(), 1e-12) << T::id;
  const std::vector<long double*> numbers = joined({all_of(code.b), all_of(code.a)});
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (*numbers[i] == 0) continue;
    const long double right = *numbers[i];
    *numbers[i] *= 1 + planted;
    EXPECT_EQ(defect() > rounding_of_steps, used[i < s ? i : (i - s) / s]) << T::id << " number " << i;
    *numbers[i] = right;
  }
}

TEST(StepDefect, ShowsAMillionthInTheCodeOfEveryExplicitTableau) {
  []<class... T>(std::type_identity<std::tuple<T...>>) {
    (expect_wrong_code_is_noticed<T>(), ...);
  }(std::type_identity<tableaux::All>{});
}

TEST(StepDefect, ShowsAMillionthInTheCodeOfStructuralMethods) {
  const Method newmark = find_method("newmark"), hht = find_method("hht_alpha"),
               alpha = find_method("generalized_alpha");
  for (const auto& [code, claimed] : {std::pair{"newmark:beta=0.25000025", &newmark},
                                      {"newmark:gamma=0.5000005", &newmark},
                                      {"hht_alpha:alpha=-0.1000001", &hht},
                                      {"generalized_alpha:rho_inf=0.8000008", &alpha}})
    EXPECT_GT(step_defect(with(find_method(code), *claimed->amplification)), rounding_of_steps) << code;
}

TEST(StepDefect, IsNothingWhereNoStepOfAGivenLengthCanBeTaken) {
  // A claim as wrong as can be, of code that takes no such steps or that is not there.
  Method rk4 = with(find_method("rk4"), *find_method("explicit_euler").amplification);
  EXPECT_GT(step_defect(rk4), 0.01);
  rk4.fixed_step = false;
  EXPECT_EQ(step_defect(rk4), 0);
  rk4.fixed_step = true;
  rk4.bind = {};
  EXPECT_EQ(step_defect(rk4), 0);
}

TEST(StepDefect, MakesAVerificationFailWhoseLimitIsNotMoved) {
  const Problem problem = make_problem("liver_linear", {.parameters = {{"c", 1.5}}});
  const Linearised near = linearised(problem);
  const Method rk4 = find_method("rk4");
  RuntimeTableau wrong = at_run_time<tableaux::Rk4>();
  wrong.b[2] *= 1 + planted;
  const Method code = with(planted_method(wrong), *rk4.amplification);
  Prediction row = predict(rk4, near);
  verify(row, code, problem, near);
  ASSERT_TRUE(row.observed);
  EXPECT_TRUE(row.observed->agrees);
  EXPECT_FALSE(row.observed->confirms());
  verify(row, rk4, problem, near);
  EXPECT_TRUE(row.observed->confirms());
}

}  // namespace
}  // namespace hmax
