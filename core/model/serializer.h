#pragma once

#include "core/model/error.h"
#include "core/model/sheet.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <deque>
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
///   void archive(Serializer& a, PendingConflict& s) { a(s.p, s.seconds); }
///
/// for a struct; for a class a member `archive(Serializer&)`. Reading trusts nothing: whatever the
/// bytes are, it returns or throws Error(Fault::scene).
class Archive {
 public:
  Archive() = default;  // writes
  // reads bytes that were written by another one
  explicit Archive(std::string_view bytes) : left_(bytes), reads_(true) {}

  bool reads() const { return reads_; }

  template <class... Things>
  void operator()(Things&... things) {
    (one(things), ...);
  }

  /// The bytes written so far.
  const std::string& bytes() const { return written_; }

  /// Throws unless a condition on what was read holds.
  void demand(bool holds) const {
    if (!holds) throw Error(Fault::scene, "state", "The bytes are not what was written.");
  }
  /// Throws unless everything was read.
  void end() const { demand(left_.empty()); }

 private:
  template <class T, class = void>
  struct HasMember : std::false_type {};
  template <class T>
  struct HasMember<T, std::void_t<decltype(std::declval<T&>().archive(std::declval<Archive&>()))>>
      : std::true_type {};

  void raw(void* values, std::size_t count) {
    static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "bytes are kept as they are");
    if (!reads_) {
      written_.append(static_cast<const char*>(values), count);
      return;
    }
    demand(count <= left_.size());
    if (count > 0) std::memcpy(values, left_.data(), count);
    left_.remove_prefix(count);
  }

  /// Number of elements that follow, of at least `least_bytes` each.
  std::size_t count(std::size_t now, std::size_t least_bytes) {
    auto n = static_cast<std::uint64_t>(now);
    raw(&n, sizeof n);
    demand(!reads_ || n <= left_.size() / std::max<std::size_t>(1, least_bytes));
    return static_cast<std::size_t>(n);
  }

  void one(bool& value) {
    char byte = value;
    raw(&byte, 1);
    value = byte != 0;
  }
  void one(std::string& text) {
    text.resize(count(text.size(), 1));
    raw(text.data(), text.size());
  }
  template <class Scalar, int Rows, int Columns, int Options, int MostRows, int MostColumns>
  void one(Eigen::Matrix<Scalar, Rows, Columns, Options, MostRows, MostColumns>& m) {
    static_assert(Columns != Eigen::Dynamic);
    if constexpr (Rows == Eigen::Dynamic)
      m.resize(count(m.rows(), sizeof(Scalar) * Columns), Columns);
    raw(m.data(), sizeof(Scalar) * m.size());
  }
  template <class T>
  void one(std::vector<T>& items) {
    constexpr bool plain = std::is_arithmetic_v<T>;
    items.resize(count(items.size(), plain ? sizeof(T) : 1));
    if constexpr (plain)
      raw(items.data(), sizeof(T) * items.size());
    else
      for (T& item : items) one(item);
  }
  template <class T>
  void one(std::deque<T>& items) {
    items.resize(count(items.size(), 1));
    for (T& item : items) one(item);
  }
  template <class A, class B>
  void one(std::pair<A, B>& both) {
    one(both.first), one(both.second);
  }
  template <class T>
  void one(std::optional<T>& thing) {
    bool there = thing.has_value();
    one(there);
    if (reads_) thing.reset();
    if (there) one(reads_ ? thing.emplace() : *thing);
  }
  template <class T>
  void one(T& thing) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      raw(&thing, sizeof thing);
    else if constexpr (HasMember<T>::value)
      thing.archive(*this);
    else
      archive(*this, thing);
  }

  std::string written_;
  std::string_view left_;
  bool reads_ = false;
};

inline void archive(Archive& a, SingularPoint& s) { a(s.pattern, s.frame_of_birth, s.cause); }
inline void archive(Archive& a, FoldLine& f) { a(f.line, f.angle); }

/// Positions, velocities and apices, for a sheet whose mesh is known already.
inline void archive_moving(Archive& a, Sheet& s) {
  a(s.x, s.v, s.singular);
  a.demand(s.x.rows() == s.pattern.rows() && (s.v.rows() == 0 || s.v.rows() == s.x.rows()));
}

inline void archive_mesh(Archive& a, Sheet& s) {
  a(s.pattern, s.triangles, s.folds);
  a.demand(s.triangles.size() == 0 ||
           (s.triangles.minCoeff() >= 0 && s.triangles.maxCoeff() < s.pattern.rows()));
}

inline void archive(Archive& a, Sheet& s) {
  archive_mesh(a, s);
  archive_moving(a, s);
}

}  // namespace paperbake
