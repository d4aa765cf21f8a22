#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"
#include "resilin/scene/node.hpp"

/// The table of keys: each key of a table of the scene file is one row that says what the key is, reads it,
/// checks it and documents it. The reader, the refusal of unknown keys and docs/scene.md all walk the same
/// rows.
namespace resilin {

/// Reference entry of a key.
struct KeyDoc {
  std::string name;
  std::string type;          ///< "number > 0"
  std::string unit;          ///< "m/s^2"; empty when it has none
  std::string default_text;  ///< "0.01"; "required"
  std::string text;          ///< one sentence
  bool is_later = false;     ///< part of the contract, not of this version
};

/// A row of the table; `read` puts the value into the struct that its table fills.
template <class T>
struct Key {
  KeyDoc doc;
  std::function<void(const SceneNode&, T&)> read;
  bool is_required = false;
};
template <class T>
using Keys = std::vector<Key<T>>;

/// A table of the scene file in the reference, such as "[simulation]"; without keys it tells what a key may
/// be.
struct TableDoc {
  std::string title;
  std::string text;
  std::vector<KeyDoc> keys;
};

/// The table as a section of a page of the docs.
std::string reference_text(const TableDoc& section);

/// Throws UnknownKeyError unless every key of the table is one of `known`; names the nearest known key.
void refuse_unknown_keys(const SceneNode& table, const std::vector<std::string>& known);
[[noreturn]] void refuse_missing_key(const SceneNode& table, const KeyDoc& key);
/// Throws "KEY is not part of this version; CURE".
[[noreturn]] void refuse_later(const SceneNode& node, const std::string& cure);

/// Reads the rows in their order, so that a row may rely on those above it. `more_keys` are known besides.
template <class T>
void read_table(const SceneNode& table, const Keys<T>& keys, T& target,
                const std::vector<std::string>& more_keys = {}) {
  expect_table(table);
  std::vector<std::string> known = more_keys;
  for (const Key<T>& key : keys) known.push_back(key.doc.name);
  refuse_unknown_keys(table, known);
  for (const Key<T>& key : keys) {
    if (table.has(key.doc.name)) {
      key.read(table.child(key.doc.name), target);
    } else if (key.is_required) {
      refuse_missing_key(table, key.doc);
    }
  }
}

/// The documentation of a table, from its rows of keys.
template <class T>
TableDoc document(std::string title, std::string text, const Keys<T>& keys) {
  TableDoc section{std::move(title), std::move(text), {}};
  for (const Key<T>& key : keys) section.keys.push_back(key.doc);
  return section;
}

/// A default value as the scene reference prints it.
std::string default_text(double value);
std::string default_text(int value);
std::string default_text(bool value);
std::string default_text(const std::string& value);
std::string default_text(const Vector3& value);
std::string default_text(const Eigen::Matrix3d& value);
std::string default_text(const std::vector<std::string>& value);
std::string one_of(const std::vector<std::string>& words);   ///< "\"a\" or \"b\""
std::string not_yet(const std::vector<std::string>& words);  ///< " Not in this version: a, b."; may be empty

/// The text when it is one of `there_is`; one of `later` is refused as not part of this version.
std::string read_choice(const SceneNode& node, const std::vector<std::string>& there_is,
                        const std::vector<std::string>& later = {});
/// A list of such texts.
std::vector<std::string> read_choices(const SceneNode& node, const std::vector<std::string>& there_is,
                                      const std::vector<std::string>& later = {});

// ---- rows for members of the usual types: the default comes from the struct itself

/// A row for a number.
template <class T>
Key<T> number_key(const char* name, double T::* member, const char* unit, const Range& range,
                  const char* text) {
  return {{name, (range.text().empty() ? "number" : "number " + range.text()), unit,
           default_text(T{}.*member), text},
          [=](const SceneNode& node, T& target) { target.*member = read_number(node, range); }};
}

/// A row for a whole number.
template <class T>
Key<T> integer_key(const char* name, int T::* member, const Range& range, const char* text) {
  return {{name, "whole number " + range.text(), "", default_text(T{}.*member), text},
          [=](const SceneNode& node, T& target) { target.*member = read_integer(node, range); }};
}

/// A row for a text.
template <class T>
Key<T> text_key(const char* name, std::string T::* member, const char* default_name, const char* text) {
  return {{name, "text", "", default_name, text},
          [=](const SceneNode& node, T& target) { target.*member = read_text(node); }};
}

/// A row for a vector, one number for each coordinate.
template <class T>
Key<T> vector_key(const char* name, Vector3 T::* member, const char* unit, const char* text) {
  return {{name, "vector", unit, default_text(T{}.*member), text},
          [=](const SceneNode& node, T& target) { target.*member = read_vector(node); }};
}

/// A row for a matrix, by rows.
template <class T>
Key<T> matrix_key(const char* name, Eigen::Matrix3d T::* member, const char* unit, const char* text) {
  return {{name, "matrix", unit, default_text(T{}.*member), text},
          [=](const SceneNode& node, T& target) { target.*member = read_matrix(node); }};
}

/// A row for one of several names; those of `later` are not available yet.
template <class T>
Key<T> choice_key(const char* name, std::string T::* member, const std::vector<std::string>& there_is,
                  const std::vector<std::string>& later, const char* text) {
  return {{name, one_of(there_is), "", default_text(T{}.*member), text + not_yet(later)},
          [=](const SceneNode& node, T& target) { target.*member = read_choice(node, there_is, later); }};
}

/// An enum with spellings.
template <Spelled Choice>
Choice read_choice(const SceneNode& node) {
  // Words that are none have been refused by the time they are looked up.
  return find_spelled<Choice>(read_choice(node, all_spellings<Choice>())).value_or(Choice{});
}

/// A row for a value of an enum, by its spelling.
template <class T, Spelled Choice>
Key<T> choice_key(const char* name, Choice T::* member, const char* text) {
  return {{name, one_of(all_spellings<Choice>()), "", default_text(spelling(T{}.*member)), text},
          [=](const SceneNode& node, T& target) { target.*member = read_choice<Choice>(node); }};
}

/// A row for a list of values of an enum.
template <class T, Spelled Choice>
Key<T> choices_key(const char* name, std::vector<Choice> T::* member, const char* text) {
  std::vector<std::string> defaults;
  const T standard{};
  for (const Choice choice : standard.*member) defaults.push_back(spelling(choice));
  return {{name, "list of " + one_of(all_spellings<Choice>()), "", default_text(defaults), text},
          [=](const SceneNode& node, T& target) {
            expect_list(node, "texts");
            (target.*member).clear();
            for (std::size_t i = 0; i < node.value->array().size(); ++i)
              (target.*member).push_back(read_choice<Choice>(node.element(i)));
          }};
}

/// A row with a reader of its own.
template <class T>
Key<T> key(KeyDoc doc, std::function<void(const SceneNode&, T&)> read) {
  const bool is_required = doc.default_text == "required";
  return {std::move(doc), std::move(read), is_required};
}

/// A key of the contract that this version does not have; `cure` says what there is.
template <class T>
Key<T> later_key(const char* name, const char* type, const char* text, const std::string& cure) {
  return {{name, type, "", "", text, true}, [=](const SceneNode& node, T&) { refuse_later(node, cure); }};
}

}  // namespace resilin
