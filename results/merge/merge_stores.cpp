#include "results/merge/merge_stores.hpp"

#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "results/compare.hpp"
#include "results/compare_limits.hpp"
#include "results/exports.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

/// What identifies a limit.
std::pair<OperatingPointKey, std::string> key_of(const LimitRow& limit) {
  return {limit.point, limit.method};
}

/// Appends to the last group where it has the same key: rows come ordered by their keys.
template <class Key, class Member>
void append(std::vector<std::pair<Key, std::vector<Member>>>& groups, const Key& key, Member member) {
  if (groups.empty() || !(groups.back().first == key)) groups.emplace_back(key, std::vector<Member>{});
  groups.back().second.push_back(std::move(member));
}

}  // namespace

struct Merger::Parts {
  /// What one session of an input has that is new.
  struct Additions {
    std::vector<Row> rows;
    std::vector<std::pair<OperatingPointKey, std::vector<LimitRow>>> limits;
    std::vector<std::pair<AdviceKey, std::vector<AdviceRecord>>> advice;
  };

  Store& out;
  MergeSummary summary;
  std::map<RowKey, Row> rows;
  std::map<std::pair<OperatingPointKey, std::string>, LimitRow> limits;
  std::set<AdviceKey> advice;
  std::optional<std::map<std::string, std::string>> notes;  ///< those that all stores so far have
  std::map<std::int64_t, Additions> additions;              ///< of the input at hand, by its sessions

  explicit Parts(Store& store) : out(store) {
    for (const Row& row : out.rows()) rows.emplace(row.key, row);
    for (const LimitRow& limit : out.limits()) limits.emplace(key_of(limit), limit);
    for (const AdviceRecord& record : out.advice()) advice.insert(record.key);
    if (!(rows.empty() && limits.empty() && advice.empty())) notes = out.notes();
  }

  /// Counts what is there already.
  void meet(std::string name, const fs::path& file, std::vector<std::string> changes) {
    if (changes.empty())
      ++summary.doubled;
    else
      summary.conflicts.push_back({std::move(name), file, std::move(changes)});
  }

  void take_rows(const Store& in) {
    for (Row& row : in.rows()) {
      const auto [known, is_new] = rows.try_emplace(row.key, row);
      std::vector<std::string> changes = changes_between(known->second, row);
      // A measured time is worth more than an explored one.
      const bool replaces = !is_new && known->second.explored && !row.explored && changes.empty();
      if (is_new || replaces) {
        // In the place of one that is counted.
        summary.added -= replaces ? 1 : 0;
        summary.doubled += replaces ? 1 : 0;
        known->second = row;
        additions[row.session].rows.push_back(std::move(row));
      } else {
        meet(benchmark_name(row.key), in.file(), std::move(changes));
      }
    }
  }

  void take_limits(const Store& in) {
    for (LimitRow& limit : in.limits()) {
      const auto [known, is_new] = limits.try_emplace(key_of(limit), limit);
      if (is_new) {
        const OperatingPointKey point = limit.point;
        auto& to = additions[limit.session].limits;
        append(to, point, std::move(limit));
        continue;
      }
      const LimitComparison both = compare_limits({&known->second, 1}, {&limit, 1});
      meet(limit_name(limit), in.file(),
           both.changed.empty() ? std::vector<std::string>{} : both.changed.front().changes);
    }
  }

  /// An answer comes whole or not at all: its rows were judged against one another.
  void take_advice(const Store& in) {
    std::set<AdviceKey> found;
    for (AdviceRecord& record : in.advice()) {
      const AdviceKey question = record.key;
      if (advice.contains(question)) {
        ++summary.doubled;
        continue;
      }
      found.insert(question);
      auto& to = additions[record.session].advice;
      append(to, question, std::move(record));
    }
    advice.merge(found);
  }

  void write(const Store& in) {
    std::map<AdviceKey, std::string> scenes, words;
    for (const AdviceScene& scene : in.scenes()) scenes.emplace(scene.key, scene.scene);
    for (const AdviceWords& each : in.advice_words()) words.emplace(each.key, each.words);
    for (const Session& session : in.sessions()) {
      const auto found = additions.find(session.id);
      if (found == additions.end()) continue;
      const Additions& added = found->second;
      out.begin_session(session.fingerprint, session.started);
      out.insert(added.rows);
      summary.added += static_cast<std::int64_t>(added.rows.size());
      for (const auto& [point, of_point] : added.limits) {
        out.insert_limits(in.operating_point(point).value(), of_point);
        summary.added += static_cast<std::int64_t>(of_point.size());
      }
      for (const auto& [question, answer] : added.advice) {
        out.insert_advice(question, answer, scenes[question], words[question]);
        summary.added += static_cast<std::int64_t>(answer.size());
      }
    }
    additions.clear();
  }

  /// Keeps the notes that all have.
  void take_notes(const Store& in) {
    const auto own = in.notes();
    if (!notes) {
      notes = own;
      for (const auto& [key, value] : own) out.note(key, value);
      return;
    }
    std::erase_if(*notes, [&](const auto& note) {
      const auto same = own.find(note.first);
      if (same != own.end() && same->second == note.second) return false;
      out.forget_note(note.first);
      return true;
    });
  }
};

Merger::Merger(Store& out) : parts_(std::make_unique<Parts>(out)) {}
Merger::~Merger() = default;

void Merger::add(const fs::path& file) {
  if (std::error_code error; fs::equivalent(file, parts_->out.file(), error))
    throw InputError(fmt::format(
        "'{}' is the output of the merge and cannot be an input; remove it from the inputs", file.string()));
  const Store in = Store::open_existing(file);
  // Notes first: a store must not say that it is of one sweep while it holds rows of another.
  parts_->take_notes(in);
  parts_->take_rows(in);
  parts_->take_limits(in);
  parts_->take_advice(in);
  parts_->write(in);
}

const MergeSummary& Merger::summary() const { return parts_->summary; }

}  // namespace hmax
