#include "formats/files/frame_statistics_table.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace paperbake {
namespace {

/// Something that any number can be made of.
struct AnyNumber {
  template <class T>
  constexpr operator T() const;
};
template <std::size_t>
constexpr AnyNumber any_number{};

template <class T, std::size_t... I>
constexpr auto holds(std::index_sequence<I...>, int) -> decltype(T{any_number<I>...}, true) {
  return true;
}
template <class T, std::size_t... I>
constexpr bool holds(std::index_sequence<I...>, long) {
  return false;
}
/// Can a T be made of that many numbers? Not of more than it has.
template <class T, std::size_t count>
constexpr bool holds_numbers = holds<T>(std::make_index_sequence<count>{}, 0);

template <class Owner>
constexpr std::size_t numbers_listed() {
  std::size_t count = 0;
  visit_frame_statistics([&](const auto& field) {
    count += std::is_same_v<typename std::decay_t<decltype(field)>::Struct, Owner>;
  });
  return count;
}

TEST(FrameStatistics, EveryNumberOfTheStructHasARowInTheList) {
  constexpr std::size_t of_frame = numbers_listed<FrameStatistics>(),
                        of_render = numbers_listed<RenderStatistics>();
  EXPECT_GT(of_frame, 20u);
  EXPECT_TRUE((holds_numbers<FrameStatistics, of_frame>));
  EXPECT_FALSE((holds_numbers<FrameStatistics, of_frame + 1>)) << "a number has no row";
  EXPECT_TRUE((holds_numbers<RenderStatistics, of_render>));
  EXPECT_FALSE((holds_numbers<RenderStatistics, of_render + 1>)) << "a number has no row";
}

TEST(FrameStatistics, EveryRowIsOfANumberOfItsOwnUnderANameOfItsOwn) {
  FrameStatistics statistics;
  statistics.render.emplace();
  std::set<const void*> numbers;
  std::set<std::string> names, in_summary;
  visit_frame_statistics([&](const auto& field) {
    EXPECT_TRUE(numbers.insert(find_statistic(statistics, field)).second) << field.name;
    if (field.name) {
      EXPECT_TRUE(names.insert(field.name).second) << field.name;
    }
    if (field.over_shot != ShotValue::none) {
      EXPECT_TRUE(in_summary.insert(field.shot_name).second) << field.shot_name;
    }
  });
  EXPECT_GT(in_summary.size(), 10u);
}

TEST(FrameStatistics, AFrameThatWasNotRenderedHasNoNumbersOfItsRenderMesh) {
  const FrameStatistics statistics;
  int of_render = 0;
  visit_frame_statistics([&](const auto& field) {
    if (find_statistic(statistics, field)) return;
    ++of_render;
    EXPECT_FALSE(statistic_value(statistics, field).has_value());
  });
  EXPECT_EQ(of_render, static_cast<int>(numbers_listed<RenderStatistics>()));
}

}  // namespace
}  // namespace paperbake
