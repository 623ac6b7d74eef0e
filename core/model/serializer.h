#pragma once

#include "core/model/error.h"
#include "core/model/sheet.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace paperbake {

/// Writes state as bytes and reads it back exactly: little-endian, doubles bit for bit. What is
/// stored of a type is listed once, for both directions:
///
///   void archive(Serializer& a, SingularPoint& s) { a(s.pattern, s.frame_of_birth, s.cause); }
///
/// for a struct; for a class a member `archive(Serializer&)`. Reading trusts nothing: whatever the
/// bytes are, it returns or throws Error(ErrorCode::scene).
class Serializer {
 public:
  Serializer() = default;  // writes
  // reads bytes that were written by another one
  explicit Serializer(std::string_view bytes) : remaining_(bytes), reads_(true) {}

  bool reads() const { return reads_; }

  template <class... Fields>
  void operator()(Fields&... things) {
    (field(things), ...);
  }

  /// The bytes written so far.
  const std::string& bytes() const { return written_; }

  /// Throws unless a condition on what was read holds.
  void require(bool holds) const {
    if (!holds) throw Error(ErrorCode::scene, "state", "The bytes are not what was written.");
  }
  /// Throws unless everything was read.
  void end() const { require(remaining_.empty()); }

 private:
  template <class T, class = void>
  struct HasMember : std::false_type {};
  template <class T>
  struct HasMember<T,
                   std::void_t<decltype(std::declval<T&>().archive(std::declval<Serializer&>()))>>
      : std::true_type {};

  void raw(void* values, std::size_t count) {
    static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "bytes are kept as they are");
    if (!reads_) {
      written_.append(static_cast<const char*>(values), count);
      return;
    }
    require(count <= remaining_.size());
    if (count > 0) std::memcpy(values, remaining_.data(), count);
    remaining_.remove_prefix(count);
  }

  /// Number of elements that follow, of at least `min_bytes` each.
  std::size_t count(std::size_t now, std::size_t min_bytes) {
    auto n = static_cast<std::uint64_t>(now);
    raw(&n, sizeof n);
    require(!reads_ || n <= remaining_.size() / std::max<std::size_t>(1, min_bytes));
    return static_cast<std::size_t>(n);
  }

  void field(bool& value) {
    char byte = value;
    raw(&byte, 1);
    value = byte != 0;
  }
  void field(std::string& text) {
    text.resize(count(text.size(), 1));
    raw(text.data(), text.size());
  }
  template <class Scalar, int Rows, int Columns, int Options, int MostRows, int MostColumns>
  void field(Eigen::Matrix<Scalar, Rows, Columns, Options, MostRows, MostColumns>& m) {
    Eigen::Index columns = Columns;
    if constexpr (Columns == Eigen::Dynamic) {
      static_assert(MostColumns != Eigen::Dynamic);
      auto some = static_cast<std::uint8_t>(m.cols());
      raw(&some, sizeof some);
      require(some > 0 && some <= MostColumns);
      columns = some;
    }
    if constexpr (Rows == Eigen::Dynamic)
      m.resize(count(m.rows(), sizeof(Scalar) * columns), columns);
    raw(m.data(), sizeof(Scalar) * m.size());
  }
  template <class T>
  void field(std::vector<T>& items) {
    if constexpr (std::is_arithmetic_v<T>) {
      items.resize(count(items.size(), sizeof(T)));
      raw(items.data(), sizeof(T) * items.size());
    } else {
      one_by_one(items);
    }
  }
  template <class T>
  void field(std::deque<T>& items) {
    one_by_one(items);
  }
  /// Items of any size in memory: they are made as they are read, so that a wrong number of them
  /// takes up no more than the bytes are worth.
  template <class Items>
  void one_by_one(Items& items) {
    std::size_t n = count(items.size(), 1);
    if (!reads_)
      for (auto& item : items) field(item);
    else
      for (items.clear(); n > 0; --n) field(items.emplace_back());
  }
  template <class Name, class Value>
  void field(std::map<Name, Value>& items) {
    std::size_t n = count(items.size(), 1);
    if (!reads_)
      for (auto& [name, value] : items) {
        Name copy = name;
        field(copy);
        field(value);
      }
    else
      for (items.clear(); n > 0; --n) {
        Name name{};
        field(name);
        field(items[name]);
      }
  }
  template <class A, class B>
  void field(std::pair<A, B>& both) {
    field(both.first);
    field(both.second);
  }
  template <class T>
  void field(std::optional<T>& thing) {
    bool there = thing.has_value();
    field(there);
    if (reads_) thing.reset();
    if (there) field(reads_ ? thing.emplace() : *thing);
  }
  template <class T>
  void field(T& thing) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      raw(&thing, sizeof thing);
    else if constexpr (HasMember<T>::value)
      thing.archive(*this);
    else
      archive(*this, thing);
  }

  std::string written_;
  std::string_view remaining_;
  bool reads_ = false;
};

inline void archive(Serializer& a, SingularPoint& s) { a(s.pattern, s.frame_of_birth, s.cause); }
inline void archive(Serializer& a, PrescribedCrease& f) { a(f.line, f.angle, f.folded); }
inline void archive(Serializer& a, CreaseEdge& e) {
  a(e.a, e.b, e.rest_angle, e.folded, e.pressed);
}

/// Positions, velocities, apices and the state of creases, for a sheet whose mesh is known already.
inline void archive_moving(Serializer& a, Sheet& s) {
  a(s.x, s.v, s.singular, s.crease_edges);
  a.require(s.x.rows() == s.pattern.rows() && (s.v.rows() == 0 || s.v.rows() == s.x.rows()));
}

inline void archive_mesh(Serializer& a, Sheet& s) {
  a(s.pattern, s.triangles, s.prescribed_creases);
  a.require(s.triangles.size() == 0 ||
            (s.triangles.minCoeff() >= 0 && s.triangles.maxCoeff() < s.pattern.rows()));
}

inline void archive(Serializer& a, Sheet& s) {
  archive_mesh(a, s);
  archive_moving(a, s);
}

}  // namespace paperbake
