#pragma once

#include <string_view>
#include <type_traits>

namespace paperbake {

// Views of the bytes of numbers as they are in memory, which is as files have them (little-endian).

template <class Number>
std::string_view bytes_of(const Number& value) {
  static_assert(std::is_arithmetic_v<Number>);
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// values  an array, a vector or a matrix
template <class Values>
std::string_view bytes_of_values(const Values& values) {
  static_assert(std::is_trivially_copyable_v<std::decay_t<decltype(*values.data())>>);
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof *values.data()};
}

}  // namespace paperbake
