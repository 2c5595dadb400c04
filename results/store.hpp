/// Where measured rows are kept: one SQLite file that survives a kill at any moment.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "results/advice_record.hpp"
#include "results/fingerprint.hpp"
#include "results/limit_row.hpp"
#include "results/row.hpp"

namespace hmax {

/// One program run that added rows to a store.
struct Session {
  std::int64_t id = 0;
  std::string started;  ///< UTC, "2024-05-06T07:08:09Z"
  Fingerprint fingerprint;
};

/// A set of measured rows with unique keys, limits of the step with theirs, the sessions that they come from,
/// and notes about the whole.
///
/// Rows are committed before insert() returns (write-ahead log, synchronous NORMAL): SIGKILL loses nothing
/// that was inserted and leaves nothing half done; a power cut may lose the last rows, never the store.
/// Several processes may read and write one store at the same time.
///
/// Every function throws InputError, one sentence with the path and the remedy, when the file cannot be used:
/// a folder that cannot be written, a full disk, a read-only or locked file, something that is no store,
/// another schema.
class Store {
 public:
  /// The number of the table layout in results/sqlite/schema.hpp; a file with another one is refused and left
  /// untouched. Numbers up to 8 are those of development versions.
  static constexpr int schema_version = 10;

  /// Opens for reading and writing; a missing file, and its folder, are created.
  static Store open_or_create(const std::filesystem::path& file);

  /// Opens a store that must exist. Reading works on read-only files and folders, writing then throws.
  static Store open_existing(const std::filesystem::path& file);

  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;
  ~Store();

  /// Rows inserted from now on belong to this session.
  /// @param started  when it began, as Session::started; empty: now
  /// @returns its id, larger than those of all sessions before
  std::int64_t begin_session(const Fingerprint& fingerprint, std::string_view started = {});

  /// Rows inserted from now on belong to this session, which the same object has begun: rows of several
  /// machines may come in any order.
  /// @throws std::logic_error  without begin_session()
  void continue_session(std::int64_t session);

  /// All of `rows` or, when this throws, none of them; Row::session is not read, the session begun or
  /// continued last is stored. A row that was measured takes the place of an explored one with its key.
  /// @throws std::logic_error       without begin_session(), or when a key is there already: ask contains()
  /// first
  /// @throws std::invalid_argument  when a number of a key is not finite
  /// @throws InputError             also when another process stored the same key since begin_session()
  void insert(std::span<const Row> rows);
  void insert(const Row& row);

  bool contains(const RowKey& key) const;
  /// The same of a row that was measured, not explored.
  bool contains_measured(const RowKey& key) const;

  /// An operating point and limits near it, in one transaction; what was stored of the same keys before is
  /// replaced. LimitRow::point of `rows` is not read.
  /// @throws std::logic_error       without begin_session()
  /// @throws std::invalid_argument  when t_end is not finite
  void insert_limits(const OperatingPointRow& point, std::span<const LimitRow> rows);

  /// The operating point of this key, if it is there.
  std::optional<OperatingPointRow> operating_point(const OperatingPointKey& key) const;
  /// The limits near it, in the order in which they were inserted first.
  std::vector<LimitRow> limits_at(const OperatingPointKey& key) const;
  /// Every limit, ordered by the key of its operating point and by method.
  std::vector<LimitRow> limits() const;

  /// The answer to a question, in one transaction; what was stored for the same question before is replaced.
  /// AdviceRecord::key of `records` is not read.
  /// @param scene  AdviceScene::scene; empty: none is stored
  /// @param words  AdviceWords::words; empty: none are stored
  /// @throws std::logic_error       without begin_session()
  /// @throws std::invalid_argument  when a number of the key is not finite
  void insert_advice(const AdviceKey& key, std::span<const AdviceRecord> records, std::string_view scene = {},
                     std::string_view words = {});
  /// Every answer, ordered by its key, and best first.
  std::vector<AdviceRecord> advice() const;
  /// The bodies of answers, ordered by their keys.
  std::vector<AdviceScene> scenes() const;
  /// What is said of answers, ordered by their keys.
  std::vector<AdviceWords> advice_words() const;

  /// Number of measured rows.
  std::int64_t size() const;

  /// Every row, bit for bit as inserted, in an order that does not depend on the order of insertion: by
  /// problem, material, parameters, y0, mode, method, control, device, precision, then h, rtol, atol, t_end
  /// from large to small.
  std::vector<Row> rows() const;

  /// Sessions by id.
  std::vector<Session> sessions() const;

  /// Sets or replaces a remark about the store as a whole, such as the sweep it was made by.
  void note(std::string_view key, std::string_view value);
  /// Removes a remark; nothing happens where there is none.
  void forget_note(std::string_view key);
  std::map<std::string, std::string> notes() const;

  const std::filesystem::path& file() const;

 private:
  struct Impl;
  explicit Store(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace hmax
