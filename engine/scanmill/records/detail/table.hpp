// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// SQLite tables of described structs (record/fields.hpp).
///
/// A number, text, enumeration or map of texts is a column. Hyphens in the name of a field become underscores. A list
/// of structs or values has a table of its own, TABLE_FIELD; the column `parent` of its rows is the `id` of the owner's
/// row. Metrics are a list, too; the unit of their lengths is the column FIELD_unit of the owner.
///
/// Every row has an `id`. Rows of one parent keep their order. NaN is stored as NULL.

#include <SQLiteCpp/SQLiteCpp.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/data/metrics.hpp"
#include "scanmill/record/json.hpp"

namespace scanmill::tables {

using RowId = std::int64_t;

// Conversion between values and columns.

template <class T>
struct Column;

template <std::integral T>
struct Column<T> {
    static constexpr const char* type = "INTEGER";
    static void bind(SQLite::Statement& row, int index, T value) { row.bind(index, static_cast<std::int64_t>(value)); }
    static void read(const SQLite::Column& column, T& value) { value = static_cast<T>(column.getInt64()); }
};
template <>
struct Column<double> {
    static constexpr const char* type = "REAL";
    static void bind(SQLite::Statement& row, int index, double value) {
        std::isnan(value) ? row.bind(index) : row.bind(index, value);
    }
    static void read(const SQLite::Column& column, double& value) {
        value = column.isNull() ? std::nan("") : column.getDouble();
    }
};
template <>
struct Column<std::string> {
    static constexpr const char* type = "TEXT";
    static void bind(SQLite::Statement& row, int index, const std::string& value) { row.bind(index, value); }
    static void read(const SQLite::Column& column, std::string& value) { value = column.getString(); }
};
template <Named T>
struct Column<T> {
    static constexpr const char* type = "TEXT";
    static void bind(SQLite::Statement& row, int index, T value) { row.bind(index, std::string(name_of(value))); }
    static void read(const SQLite::Column& column, T& value) {
        const std::string name = column.getString();
        if (const std::optional<T> found = value_named<T>(name))
            value = *found;
        else
            throw Error("the column '{}' has the unknown value '{}'", column.getName(), name);
    }
};
template <>
struct Column<LengthUnit> {
    static constexpr const char* type = "TEXT";
    static void bind(SQLite::Statement& row, int index, LengthUnit unit) { row.bind(index, std::string(symbol(unit))); }
    static void read(const SQLite::Column& column, LengthUnit& unit) {
        unit = length_unit(column.getString()).value_or(LengthUnit::unknown);
    }
};
template <class T>
struct Column<std::optional<T>> {
    static void bind(SQLite::Statement& row, int index, const std::optional<T>& value) {
        value ? Column<T>::bind(row, index, *value) : row.bind(index);
    }
    static void read(const SQLite::Column& column, std::optional<T>& value) {
        value.reset();
        if (!column.isNull()) Column<T>::read(column, value.emplace());
    }
};
/// Texts by name are stored as the text of a JSON object.
template <>
struct Column<std::vector<std::pair<std::string, std::string>>> {
    using Texts = std::vector<std::pair<std::string, std::string>>;
    static constexpr const char* type = "TEXT";
    static void bind(SQLite::Statement& row, int index, const Texts& texts) {
        row.bind(index, text_of(json_of(texts)));
    }
    static void read(const SQLite::Column& column, Texts& texts) {
        read_json(Json::parse(column.getString(), nullptr, false), texts, column.getName());
    }
};

template <class T>
concept IsColumn = requires(const SQLite::Column& column, T& value) { Column<T>::read(column, value); };
template <class T>
inline constexpr bool is_metrics = std::same_as<T, Metrics>;

/// A row for an item of a list of plain values.
template <class T>
struct Item {
    T value;
};
template <class T>
constexpr auto fields(const Item<T>*) {
    return std::tuple{field("value", &Item<T>::value)};
}

/// Keeps prepared statements, found by their text.
class Statements {
public:
    explicit Statements(SQLite::Database& database) : database_(database) {}
    SQLite::Statement& get(const std::string& sql) {
        const auto found = prepared_.find(sql);
        SQLite::Statement& statement =
            found != prepared_.end() ? found->second : prepared_.try_emplace(sql, database_, sql).first->second;
        statement.tryReset();  // needed after a failure, too
        return statement;
    }
    SQLite::Database& database() { return database_; }

private:
    SQLite::Database& database_;
    std::map<std::string, SQLite::Statement> prepared_;
};

inline std::string column_name(std::string name) {
    std::ranges::replace(name, '-', '_');
    return name;
}

/// Calls on_column(name, member) for every field that is a column, and on_list(name, member) for every list. Fields
/// that are structs are visited as if their fields were fields of `object`.
template <class T, class OnColumn, class OnList>
void visit(auto& object, OnColumn&& on_column, OnList&& on_list) {
    for_each_field<T>([&](const auto& field) {
        auto& member = object.*field.member;
        using Member = std::remove_cvref_t<decltype(member)>;
        if constexpr (is_metrics<Member>) {
            on_column(column_name(field.name) + "_unit", member.unit);
            on_list(column_name(field.name), member.values);
        } else if constexpr (IsColumn<Member>) {
            on_column(column_name(field.name), member);
        } else if constexpr (Described<Member>) {
            visit<Member>(member, on_column, on_list);
        } else {
            on_list(column_name(field.name), member);
        }
    });
}

template <class T>
constexpr auto row_type() {
    if constexpr (Described<T>)
        return std::type_identity<T>();
    else
        return std::type_identity<Item<T>>();
}
/// The struct that holds a row of the list's table.
template <class List>
using RowOf = typename decltype(row_type<typename List::value_type>())::type;

/// The quoted names of the columns, with `before` in front of each.
template <class T>
std::string column_list(const std::string& before) {
    std::string names;
    const T object{};
    visit<T>(
        object, [&](const std::string& name, const auto&) { names += before + '"' + name + '"'; },
        [](const std::string&, const auto&) {});
    return names;
}

/// SQL statements that create the table, its index, and the tables of its lists. `parent` is the table of the owner;
/// empty: no owner.
template <class T>
std::string creation(const std::string& table, const std::string& parent) {
    std::string columns, lists;
    const T object{};
    visit<T>(
        object,
        [&](const std::string& name, const auto& value) {
            columns += ", \"" + name + "\" " + Column<std::remove_cvref_t<decltype(value)>>::type;
        },
        [&](const std::string& name, const auto& list) {
            lists += creation<RowOf<std::remove_cvref_t<decltype(list)>>>(table + "_" + name, table);
        });
    const std::string owner = parent.empty() ? "" : ", parent INTEGER NOT NULL REFERENCES " + parent;
    const std::string index =
        parent.empty() ? "" : "CREATE INDEX " + table + "_of_" + parent + " ON " + table + " (parent);\n";
    return "CREATE TABLE " + table + " (id INTEGER PRIMARY KEY" + owner + columns + ");\n" + index + lists;
}

/// Inserts a row and the rows of its lists. Returns the row's id.
template <class T>
RowId insert(Statements& statements, const std::string& table, const T& object, std::optional<RowId> parent = {}) {
    static const std::string columns = column_list<T>(", ");
    const std::size_t count = static_cast<std::size_t>(std::ranges::count(columns, ','));
    std::string marks = parent ? "?" : "NULL";
    for (std::size_t i = 0; i < count; ++i) marks += ", ?";
    SQLite::Statement& row = statements.get("INSERT INTO " + table + " (" + (parent ? "parent" : "id") + columns +
                                            ") VALUES (" + marks + ")");
    int index = 0;
    if (parent) row.bind(++index, *parent);
    visit<T>(
        object,
        [&](const std::string&, const auto& value) {
            Column<std::remove_cvref_t<decltype(value)>>::bind(row, ++index, value);
        },
        [](const std::string&, const auto&) {});
    row.exec();
    const RowId id = statements.database().getLastInsertRowid();
    visit<T>(
        object, [](const std::string&, const auto&) {},
        [&](const std::string& name, const auto& list) {
            using Row = RowOf<std::remove_cvref_t<decltype(list)>>;
            for (const auto& item : list)
                if constexpr (Described<std::remove_cvref_t<decltype(item)>>)
                    insert<Row>(statements, table + "_" + name, item, id);
                else
                    insert<Row>(statements, table + "_" + name, Row{item}, id);
        });
    return id;
}

/// Reads the columns of T, which begin at column `first`.
template <class T>
void read_columns(SQLite::Statement& row, int first, T& object) {
    visit<T>(
        object,
        [&](const std::string&, auto& value) {
            Column<std::remove_cvref_t<decltype(value)>>::read(row.getColumn(first++), value);
        },
        [](const std::string&, auto&) {});
}

/// Rows of a table with their lists.
template <class T>
struct Rows {
    std::vector<T> objects;
    std::vector<RowId> ids;
    std::vector<std::size_t> owners;  ///< index into the `parents` of read_rows(), for each row
};

template <class T>
void read_lists(SQLite::Database& database, const std::string& table, std::vector<T*> objects,
                const std::vector<RowId>& ids);

/// The rows of these parents, parent by parent. Pre: `parents` are ascending ids.
template <class T>
Rows<T> read_rows(SQLite::Database& database, const std::string& table, const std::vector<RowId>& parents) {
    Rows<T> rows;
    if (parents.empty()) return rows;
    SQLite::Statement query(database, "SELECT id, parent" + column_list<T>(", ") + " FROM " + table +
                                          " WHERE parent BETWEEN ? AND ? ORDER BY parent, id");
    query.bind(1, parents.front());
    query.bind(2, parents.back());
    std::size_t owner = 0;
    while (query.executeStep()) {
        const RowId parent = query.getColumn(1).getInt64();
        while (parents[owner] < parent) ++owner;
        if (parents[owner] != parent) continue;
        rows.ids.push_back(query.getColumn(0).getInt64());
        rows.owners.push_back(owner);
        read_columns(query, 2, rows.objects.emplace_back());
    }
    std::vector<T*> objects;
    for (T& object : rows.objects) objects.push_back(&object);
    read_lists<T>(database, table, std::move(objects), rows.ids);
    return rows;
}

/// The row with this id; empty if it does not exist.
template <class T>
std::optional<T> read_row(SQLite::Database& database, const std::string& table, RowId id) {
    SQLite::Statement query(database, "SELECT id" + column_list<T>(", ") + " FROM " + table + " WHERE id = ?");
    query.bind(1, id);
    if (!query.executeStep()) return std::nullopt;
    T object;
    read_columns(query, 1, object);
    read_lists<T>(database, table, {&object}, {id});
    return object;
}

template <class T>
void read_lists(SQLite::Database& database, const std::string& table, std::vector<T*> objects,
                const std::vector<RowId>& ids) {
    T shape{};
    std::size_t which = 0;
    visit<T>(
        shape, [](const std::string&, auto&) {},
        [&](const std::string& name, auto& shape_list) {
            using List = std::remove_cvref_t<decltype(shape_list)>;
            const std::size_t index = which++;
            std::vector<List*> lists;
            for (T* object : objects) {
                std::size_t at = 0;
                visit<T>(
                    *object, [](const std::string&, auto&) {},
                    [&](const std::string&, auto& list) {
                        if constexpr (std::same_as<std::remove_cvref_t<decltype(list)>, List>)
                            if (at == index) lists.push_back(&list);
                        ++at;
                    });
            }
            auto rows = read_rows<RowOf<List>>(database, table + "_" + name, ids);
            for (std::size_t i = 0; i < rows.objects.size(); ++i)
                if constexpr (Described<typename List::value_type>)
                    lists[rows.owners[i]]->push_back(std::move(rows.objects[i]));
                else
                    lists[rows.owners[i]]->push_back(std::move(rows.objects[i].value));
        });
}

}  // namespace scanmill::tables
