#include "results/store.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "results/json.hpp"
#include "results/patience.hpp"
#include "results/sqlite/columns.hpp"
#include "results/sqlite/row_digest.hpp"
#include "results/sqlite/schema.hpp"
#include "results/sqlite/sqlite.hpp"
#include "results/sqlite/store_impl.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;
using sqlite::Database;
using sqlite::Statement;

Patience patience;

/// What SQLite calls again and again while another process has the lock. @returns 0 to give up
int on_busy(void* /*unused*/, int calls) {
  using Clock = std::chrono::steady_clock;
  thread_local Clock::time_point start;
  thread_local bool told = false;
  if (calls == 0) {
    start = Clock::now();
    told = false;
  }
  const auto waited = Clock::now() - start;
  if (waited >= std::chrono::milliseconds(patience.milliseconds)) return 0;
  if (!told && patience.tell && waited >= std::chrono::seconds(1)) {
    told = true;
    patience.tell("another process has locked the store; waiting until it is done");
  }
  sqlite3_sleep(10);
  return 1;
}

}  // namespace

InputError translated(const sqlite::Failure& failure, const fs::path& file) {
  const std::string path = file.string();
  const std::string cause =
      failure.system_error != 0 ? std::strerror(failure.system_error) : std::string(failure.what());
  switch (failure.code & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return InputError(
          fmt::format("The store '{}' is locked by another process: wait until it ends, or stop it.", path));
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return InputError(fmt::format(
          "The store '{}' is read-only: make the file and its folder writable, or choose another file.",
          path));
    case SQLITE_NOTADB:
      return InputError(fmt::format(
          "'{}' is not a store of hmax but some other file, left untouched: choose another file.", path));
    case SQLITE_CORRUPT:
    case SQLITE_ERROR:  // a statement does not fit the tables, which were those of this layout
      return InputError(
          fmt::format("The store '{0}' is damaged ({1}): restore a copy, or save what is readable with "
                      "`sqlite3 '{0}' .recover`.",
                      path, failure.what()));
    case SQLITE_FULL:
    case SQLITE_IOERR:
      return InputError(
          fmt::format("Cannot write to the store '{}' ({}): free some space or choose another disk; every "
                      "row stored before is kept.",
                      path, cause));
    default:
      return InputError(
          fmt::format("Cannot use the store '{}' ({}): make the file and its folder readable and writable, "
                      "or choose another file.",
                      path, cause));
  }
}

InputError translated(const sqlite::DamagedRow& damage, const fs::path& file) {
  return InputError(fmt::format(
      "The store '{0}' is damaged ({1}): restore a copy, or remove the row with `sqlite3 '{0}' \"DELETE FROM "
      "{2} WHERE rowid = {3}\"`.",
      file.string(), damage.what(), damage.table, damage.row));
}

namespace {

Database connect(const std::string& name, int flags) {
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(name.c_str(), &raw, flags, nullptr);
  Database database(raw);
  if (!database) throw sqlite::Failure(code, 0, sqlite3_errstr(code));
  sqlite3_extended_result_codes(raw, 1);
  sqlite::check(raw, code);
  sqlite3_busy_handler(raw, on_busy, nullptr);
  sqlite::add_row_digest(raw);
  return database;
}

/// For a folder in which no log file can be made: reads the file as it is, which is complete when no log is
/// left.
Database connect_immutable(const fs::path& absolute) {
  std::string uri = "file:";
  for (const char c : absolute.string()) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/';
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return connect(uri + "?immutable=1", SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
}

struct Identity {
  std::int64_t application, version, tables;
};

/// Needs a transaction around it: between two of its questions another process may lay out the file.
Identity identity(sqlite3* database) {
  return {.application = sqlite::integer(database, "PRAGMA application_id"),
          .version = sqlite::integer(database, "PRAGMA user_version"),
          .tables = sqlite::integer(database, "SELECT count(*) FROM sqlite_master")};
}

bool is_empty(const Identity& id) { return id.application == 0 && id.version == 0 && id.tables == 0; }

/// Changing the journal mode turns a read lock into a write lock. Where two processes do so at the same time,
/// SQLite refuses one at once, however patient it is, rather than let each wait for the other; it tries
/// again.
void keep_a_write_ahead_log(sqlite3* database) {
  constexpr int pause_ms = 5;
  for (int waited_ms = 0;; waited_ms += pause_ms) {
    try {
      return sqlite::execute(database, "PRAGMA journal_mode = WAL");
    } catch (const sqlite::Failure& failure) {
      if ((failure.code & 0xff) != SQLITE_BUSY || waited_ms >= patience.milliseconds) throw;
      sqlite3_sleep(pause_ms);
    }
  }
}

/// Lays out an empty file; another process may do the same at the same time.
void lay_out(sqlite3* database) {
  keep_a_write_ahead_log(database);
  sqlite::Transaction transaction(database);
  if (!is_empty(identity(database))) return;
  sqlite::execute(database, store_schema().c_str());
  sqlite::execute(database, fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                        store_application_id, Store::schema_version)
                                .c_str());
  transaction.commit();
}

std::string names_of_columns() {
  return sqlite::joined("", "", ", ", row_key_fields, row_fields) + ", session";
}

void bind_row(Statement& statement, const Row& row, std::int64_t session) {
  int index = 0;
  sqlite::bind_key(statement, index, row.key, row_key_fields);
  sqlite::bind_fields(statement, index, row, row_fields);
  statement.bind(index, session);
}

std::string describe(const RowKey& key) {
  return fmt::format("{} {} {} {}{} h={} rtol={}", key.problem, key.material, key.method, key.mode,
                     key.device.empty() ? "" : " on " + key.device, to_text(key.h), to_text(key.rtol));
}

/// Throws where there is something else than a store, or nothing and none is to be made; makes its folder.
void prepare_place(const fs::path& file, const fs::path& absolute, bool create) {
  const std::string path = file.string();
  std::error_code error;
  const fs::file_status status = fs::status(absolute, error);
  if (fs::is_directory(status)) {
    throw InputError(fmt::format("'{}' is a folder, not a store: name a file inside it.", path));
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw InputError(fmt::format("'{}' is not a regular file: name another file for the store.", path));
  }
  // SQLite takes a file shorter than its header for an empty database, and would write over it.
  if (constexpr std::uintmax_t header = 100; fs::exists(status)) {
    const std::uintmax_t size = fs::file_size(absolute, error);
    if (!error && size > 0 && size < header) throw translated({SQLITE_NOTADB, 0, "too short"}, file);
  }
  if (!fs::exists(status)) {
    if (!create)
      throw InputError(
          fmt::format("There is no store '{}': check the path, or make it with `hmax sweep`.", path));
    fs::create_directories(absolute.parent_path(), error);
    if (error) {
      throw InputError(
          fmt::format("Cannot make the folder of the store '{}' ({}): choose a folder that can be written.",
                      path, error.message()));
    }
  }
}

Identity identity_now(const Database& opened) {
  sqlite::execute(opened.get(), "BEGIN");
  const Identity found = identity(opened.get());
  sqlite::execute(opened.get(), "COMMIT");
  return found;
}

/// A file that can be read, and written if `create`.
std::pair<Database, Identity> connected(const fs::path& absolute, bool create) {
  Database database = connect(absolute.string(), SQLITE_OPEN_READWRITE | (create ? SQLITE_OPEN_CREATE : 0));
  Identity id{};
  try {
    id = identity_now(database);
  } catch (const sqlite::Failure& failure) {
    const int code = failure.code & 0xff;
    std::error_code error;
    fs::path log = absolute;
    log += "-wal";
    const bool log_left = fs::exists(log, error) && fs::file_size(log, error) > 0;
    if (create || log_left || (code != SQLITE_CANTOPEN && code != SQLITE_READONLY)) throw;
    database = connect_immutable(absolute);
    id = identity_now(database);
  }
  if (create && sqlite3_db_readonly(database.get(), "main") == 1) {
    throw sqlite::Failure(SQLITE_READONLY, 0, "read-only");
  }
  return {std::move(database), id};
}

/// Lays out an empty file if `create`; throws where no store of today's layout results.
void settle(const Database& database, Identity id, const std::string& path, bool create) {
  if (create && is_empty(id)) {
    lay_out(database.get());
    id = identity_now(database);
  }
  if (is_empty(id)) {
    throw InputError(fmt::format("'{}' is empty, not a store: make one with `hmax sweep`.", path));
  }
  if (id.application != store_application_id) {
    throw InputError(fmt::format(
        "'{}' is an SQLite file but not a store of hmax, left untouched: choose another file.", path));
  }
  if (id.version != Store::schema_version) {
    throw InputError(
        fmt::format("The store '{}' has schema {} but this hmax uses schema {}; it is left untouched: "
                    "choose another file, or export it with the hmax that made it.",
                    path, id.version, Store::schema_version));
  }
}

}  // namespace

void sqlite::bind(Statement& statement, int index, const std::vector<double>& values) {
  std::string json = "[";
  for (const double value : values) {
    if (json.size() > 1) json += ',';
    json += std::isfinite(value) && !is_special(value) ? to_text(value) : '"' + to_text(value) + '"';
  }
  statement.bind(index, json + "]");
}

void sqlite::read(const Statement& query, int column, std::vector<double>& values) {
  try {
    for (const nlohmann::json& entry : nlohmann::json::parse(query.text(column)))
      values.push_back(entry.is_string() ? to_number(entry.get<std::string>()).value_or(std::nan(""))
                                         : entry.get<double>());
  } catch (const nlohmann::json::exception&) {
    throw Failure(SQLITE_CORRUPT, 0, "times that cannot be read");
  }
}

void set_patience(Patience with) { patience = with; }

std::int64_t Store::Impl::id_of(const RowKey& key) const {
  if (!find)
    find = std::make_unique<Statement>(
        db(), ("SELECT id FROM rows WHERE " + sqlite::joined("", " = ?", " AND ", row_key_fields)).c_str());
  int index = 0;
  sqlite::bind_key(*find, index, key, row_key_fields);
  const std::int64_t id = find->step() ? find->integer(0) : 0;
  find->reset();
  return id;
}

std::unique_ptr<Store::Impl> Store::Impl::open(const fs::path& file, bool create) {
  std::error_code error;
  const fs::path absolute = fs::absolute(file, error);
  prepare_place(file, absolute, create);
  return reporting(file, [&] {
    auto [database, id] = connected(absolute, create);
    settle(database, id, file.string(), create);
    sqlite::check_store(database.get());
    sqlite::execute(database.get(), "PRAGMA synchronous = NORMAL");
    return std::make_unique<Impl>(file, std::move(database));
  });
}

Store::Store(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;
Store::~Store() = default;

Store Store::open_or_create(const fs::path& file) { return Store(Impl::open(file, true)); }
Store Store::open_existing(const fs::path& file) { return Store(Impl::open(file, false)); }

std::int64_t Store::begin_session(const Fingerprint& fingerprint, std::string_view started) {
  return reporting(impl_->file, [&] {
    sqlite::Transaction transaction(impl_->db());
    Statement now(impl_->db(), "SELECT strftime('%Y-%m-%dT%H:%M:%SZ', 'now')");
    Statement add(impl_->db(), sqlite::insert_into("sessions", "started, fingerprint").c_str());
    add.bind(0, !started.empty() || !now.step() ? std::string(started) : now.text(0));
    add.bind(1, to_json(fingerprint));
    add.run();
    const std::int64_t session = sqlite3_last_insert_rowid(impl_->db());
    transaction.commit();
    impl_->session = session;
    return session;
  });
}

void Store::continue_session(std::int64_t session) {
  if (impl_->session == 0) throw std::logic_error("Store::continue_session needs begin_session() first.");
  impl_->session = session;
}

void Store::insert(std::span<const Row> rows) {
  if (impl_->session == 0) throw std::logic_error("Store::insert needs begin_session() first.");
  // Rows of this span or session are the caller's mistake; a row that another process has added since the
  // caller looked is not.
  const auto refuse = [&](const RowKey& key, std::int64_t existing) {
    Statement owner(impl_->db(), "SELECT session FROM rows WHERE id = ?");
    owner.bind(0, existing);
    const bool foreign = owner.step() && owner.integer(0) != impl_->session;
    if (foreign) {
      throw InputError(fmt::format(
          "Another process stored the row '{}' in '{}' at the same time: wait until it ends, then resume.",
          describe(key), impl_->file.string()));
    }
    throw std::logic_error(
        fmt::format("The row '{}' is in the store '{}' already.", describe(key), impl_->file.string()));
  };
  const auto gives_way = [&](std::int64_t existing) {
    Statement remove(impl_->db(), "DELETE FROM rows WHERE id = ? AND explored");
    remove.bind(0, existing);
    remove.run();
    return sqlite3_changes(impl_->db()) > 0;
  };
  reporting(impl_->file, [&] {
    sqlite::Transaction transaction(impl_->db());
    if (!impl_->insert)
      impl_->insert =
          std::make_unique<Statement>(impl_->db(), sqlite::insert_into("rows", names_of_columns()).c_str());
    for (const Row& row : rows) {
      if (const std::int64_t existing = impl_->id_of(row.key);
          existing != 0 && (row.explored || !gives_way(existing)))
        refuse(row.key, existing);
      bind_row(*impl_->insert, row, impl_->session);
      impl_->insert->run();
    }
    transaction.commit();
  });
}

void Store::insert(const Row& row) { insert(std::span<const Row>(&row, 1)); }

bool Store::contains(const RowKey& key) const {
  return reporting(impl_->file, [&] { return impl_->id_of(key) != 0; });
}

bool Store::contains_measured(const RowKey& key) const {
  return reporting(impl_->file, [&] {
    Statement query(impl_->db(), "SELECT 1 FROM rows WHERE id = ? AND NOT explored");
    query.bind(0, impl_->id_of(key));
    return query.step();
  });
}

std::int64_t Store::size() const {
  return reporting(impl_->file, [&] { return sqlite::integer(impl_->db(), "SELECT count(*) FROM rows"); });
}

std::vector<Row> Store::rows() const {
  return reporting(impl_->file, [&] {
    Statement query(
        impl_->db(),
        fmt::format("SELECT {} FROM rows ORDER BY {}", names_of_columns(), order_of_rows).c_str());
    return sqlite::read_rows(query, &Row::key, row_key_fields, row_fields);
  });
}

std::vector<Session> Store::sessions() const {
  return reporting(impl_->file, [&] {
    std::vector<Session> sessions;
    Statement query(impl_->db(), "SELECT id, started, fingerprint FROM sessions ORDER BY id");
    while (query.step()) {
      sessions.push_back({query.integer(0), query.text(1), fingerprint_from_json(query.text(2))});
    }
    return sessions;
  });
}

void Store::note(std::string_view key, std::string_view value) {
  reporting(impl_->file, [&] {
    Statement set(impl_->db(),
                  (sqlite::insert_into("notes", "key, value") +
                   " ON CONFLICT (key) DO UPDATE SET value = excluded.value, digest = excluded.digest")
                      .c_str());
    set.bind(0, key);
    set.bind(1, value);
    set.run();
  });
}

void Store::forget_note(std::string_view key) {
  reporting(impl_->file, [&] {
    Statement remove(impl_->db(), "DELETE FROM notes WHERE key = ?");
    remove.bind(0, key);
    remove.run();
  });
}

std::map<std::string, std::string> Store::notes() const {
  return reporting(impl_->file, [&] {
    std::map<std::string, std::string> notes;
    Statement query(impl_->db(), "SELECT key, value FROM notes");
    while (query.step()) notes.emplace(query.text(0), query.text(1));
    return notes;
  });
}

const fs::path& Store::file() const { return impl_->file; }

}  // namespace hmax
