// SPDX-License-Identifier: MIT
// The kinds of scene keys: a number, a whole number, a choice, a text, a surface file with its companions.
#pragma once

#include "formats/scene/scene_keys.hpp"
#include "formats/scene/scene_source.hpp"

namespace palpate::scene_io {

template <class T>
Key<T> number(const char* name, double T::*member, Range range, const char* help) {
  return {name,
          Affects::solves,
          help,
          range.text(),
          [=](T& target, const toml::node& value, const toml::table&, const Place& place) {
            target.*member = to_number(place, value, range);
          },
          [=](const T& target) { return show(target.*member); },
          ""};
}

template <class T>
Key<T> integer(const char* name, int T::*member, Range range, const char* help, int multiple_of = 1) {
  return {name,
          Affects::solves,
          help,
          (multiple_of == 1   ? ""
           : multiple_of == 2 ? "even, "
                              : "a multiple of " + std::to_string(multiple_of) + ", ") +
              range.text(),
          [=](T& target, const toml::node& value, const toml::table&, const Place& place) {
            target.*member = to_integer(place, value, range, multiple_of);
          },
          [=](const T& target) { return show(target.*member); },
          ""};
}

/// `choices` in the order of the enumerators.
template <class T, class E>
Key<T> choice(const char* name, E T::*member, std::vector<std::string> choices, const char* help) {
  return {name,
          Affects::solves,
          help,
          show_choices(choices),
          [=](T& target, const toml::node& value, const toml::table&, const Place& place) {
            target.*member = static_cast<E>(to_choice(place, value, choices));
          },
          [=](const T& target) { return show(choices[static_cast<std::size_t>(target.*member)]); },
          ""};
}

/// `good`: what a text has to meet beyond those of to_text; `allowed` says it.
template <class T>
Key<T> text(const char* name, std::string T::*member, const char* help, const char* example, const std::string& allowed,
            bool (*good)(const std::string&)) {
  return {name,
          Affects::nothing,
          help,
          allowed,
          [=](T& target, const toml::node& value, const toml::table&, const Place& place) {
            target.*member = to_text(place, value);
            if (!good(target.*member)) fail_value(place, value, allowed);
          },
          [=](const T& target) { return (target.*member).empty() ? "" : show(target.*member); },
          example};
}

template <class T>
Keys<T> join(Keys<T> first, const Keys<T>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

template <class T>
Key<T> affecting(Affects affects, Key<T> key) {
  key.affects = affects;
  return key;
}

template <class T>
Key<T> formerly(const char* former, Key<T> key) {
  key.former = former;
  return key;
}

/// The keys `meshes` and `units`, which the reader of `surface` takes up: here only that they do not stand alone.
template <class T>
Keys<T> source_keys(std::function<const SurfaceSource*(const T&)> source) {
  const auto beside = [](T&, const toml::node& value, const toml::table& parent, const Place& place) {
    if (!parent.contains("surface")) fail(place, &value, "there is no 'surface' that it could apply to");
  };
  return {{"meshes", Affects::solves, "Names of the meshes or nodes to take from the file; left out: all.",
           "one or more texts", beside,
           [=](const T& target) {
             const SurfaceSource* from = source(target);
             return from == nullptr || from->meshes.empty() ? "" : show(from->meshes);
           },
           "[\"NAME\"]"},
          {"units", Affects::solves, "Length unit of the file.", show_choices(unit_names()), beside,
           [=](const T& target) {
             const SurfaceSource* from = source(target);
             return from == nullptr || from->file.empty() ? "" : show_unit(from->unit);
           },
           "\"m\""}};
}

template <class T>
Keys<T> surface_keys(SurfaceSource T::*member, const char* help) {
  Keys<T> keys{{"surface", Affects::nothing, help, "a file name, relative to the scene file",
                [=](T& target, const toml::node& value, const toml::table& parent, const Place& place) {
                  target.*member = source_beside(to_text(place, value), parent, above(place));
                },
                [=](const T& target) {
                  const std::string file = (target.*member).file.string();
                  return file.empty() ? "" : show(file);
                },
                "\"FILE\""}};
  return join(keys, source_keys<T>([=](const T& target) { return &(target.*member); }));
}

}  // namespace palpate::scene_io
