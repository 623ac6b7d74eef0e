#pragma once

#include "core/model/frame_statistics.h"

#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>

namespace paperbake {

/// The unit that files give a number in: its value in SI, `times` / `over` of which make one.
struct StatisticUnit {
  const char* symbol = "";
  double times = 1, over = 1;
  double of(double value) const { return value * times / over; }
  double to_si(double value) const { return value * over / times; }
};

/// What cert/summary.json makes of a number over the frames of a shot.
enum class ShotValue {
  none,
  spread,  // {mean, max, frame_of_max}
  sum,
  largest,
  frames_not,  // how many frames have it 0 or false
};

/// A line of a chart in report.html, one value a frame.
struct ReportCurve {
  const char* label = nullptr;  // null: it is not drawn
  int chart = 0;                // lines of the same number share a chart
  enum OverSheets { worst, sum } over_sheets = worst;
};

/// A column of wedge.csv, one value a bake.
struct WedgeColumn {
  const char* name = nullptr;  // null: there is none
  enum Value { mean, largest, of_shot, last_frame } value = of_shot;
};

/// A row of visit_frame_statistics: one number, and who writes it under which name and in which
/// unit. Owner: FrameStatistics or RenderStatistics
template <class Owner, class T>
struct StatisticField {
  using Struct = Owner;
  using Value = T;
  T Owner::*member;
  const char* name;  // in cert/frames.jsonl; null: only checkpoints keep it
  StatisticUnit unit = {};
  ShotValue over_shot = ShotValue::none;
  const char* shot_name = nullptr;  // in cert/summary.json
  ReportCurve curve = {};
  WedgeColumn column = {};
  // in its unit: how near `verify` must find it from the files alone; empty: it is not in them
  std::optional<double> tolerance = {};

  constexpr StatisticField in(StatisticUnit u) const {
    StatisticField field = *this;
    field.unit = u;
    return field;
  }
  /// other_name: where it has another in the summary
  constexpr StatisticField summarized_as(ShotValue value, const char* other_name = nullptr) const {
    StatisticField field = *this;
    field.over_shot = value;
    field.shot_name = other_name ? other_name : name;
    return field;
  }
  constexpr StatisticField drawn_as(ReportCurve c) const {
    StatisticField field = *this;
    field.curve = c;
    return field;
  }
  constexpr StatisticField in_wedge_as(WedgeColumn c) const {
    StatisticField field = *this;
    field.column = c;
    return field;
  }
  constexpr StatisticField verified_within(double t) const {
    StatisticField field = *this;
    field.tolerance = t;
    return field;
  }
};

/// The number itself, in FrameStatistics or const FrameStatistics. null: it is of the render mesh,
/// and the frame was not rendered
template <class Statistics, class Owner, class T>
auto find_statistic(Statistics& s, const StatisticField<Owner, T>& field)
    -> decltype(&(s.*std::declval<T FrameStatistics::*>())) {
  if constexpr (std::is_same_v<Owner, RenderStatistics>)
    return s.render ? &(*s.render.*field.member) : nullptr;
  else
    return &(s.*field.member);
}

/// The number in the unit of its field.
template <class Field>
std::optional<double> statistic_value(const FrameStatistics& s, const Field& field) {
  const auto* value = find_statistic(s, field);
  return value ? std::optional(field.unit.of(static_cast<double>(*value))) : std::nullopt;
}

namespace statistics {

using S = FrameStatistics;
using R = RenderStatistics;
using Curve = ReportCurve;
using Column = WedgeColumn;

constexpr StatisticUnit percent{"%", 100}, degrees{"deg", 180, M_PI}, millimetres{"mm", 1e3},
    milliseconds{"ms"}, joules{"J"};
constexpr auto spread = ShotValue::spread;

template <class T>
constexpr StatisticField<S, T> number(T S::*member, const char* name) {
  return {member, name};
}
template <class T>
constexpr StatisticField<R, T> rendered(T R::*member, const char* name) {
  return {member, name};
}

/// Numbers of the simulated mesh.
template <class Visit>
constexpr void visit_mesh(Visit&& visit) {
  visit(number(&S::triangles, "triangles")
            .summarized_as(spread)
            .drawn_as({"triangles simulated", 3, Curve::sum}));
  visit(number(&S::stretch_mean, "stretch_mean_pct")
            .in(percent)
            .summarized_as(spread)
            .drawn_as({"c_m", 1})
            .in_wedge_as({"c_m_pct", Column::mean}));
  visit(number(&S::stretch_max, "stretch_max_pct")
            .in(percent)
            .summarized_as(spread)
            .drawn_as({"worst edge", 2})
            .in_wedge_as({"worst_edge_pct", Column::largest}));
  visit(number(&S::angle_defect_max, "angle_defect_max_deg").in(degrees).summarized_as(spread));
  visit(number(&S::handle_error_max, "handle_err_max_mm")
            .in(millimetres)
            .summarized_as(spread)
            .drawn_as({"worst handle", 6})
            .verified_within(1e-3));
  visit(number(&S::singular, "singular").drawn_as({"singular points", 5, Curve::sum}));
  visit(number(&S::new_singular, "new_singular")
            .summarized_as(ShotValue::sum, "singular")
            .in_wedge_as({"singular", Column::of_shot}));
  visit(number(&S::folds, "folds").summarized_as(ShotValue::largest));
}

/// Numbers of the step that led to it.
template <class Visit>
constexpr void visit_step(Visit&& visit) {
  visit(number(&S::elastic_ms, "elastic_ms")
            .in(milliseconds)
            .summarized_as(spread)
            .drawn_as({"elastic", 4, Curve::sum}));
  visit(number(&S::geometry_ms, "geometry_ms")
            .in(milliseconds)
            .summarized_as(spread)
            .drawn_as({"geometry", 4, Curve::sum}));
  visit(number(&S::moved, "moved_mm").in(millimetres).summarized_as(spread));
  visit(number(&S::driven, "driven_mm").in(millimetres));
  visit(number(&S::inertia, "inertia"));
  visit(number(&S::substeps, "substeps"));
  visit(number(&S::newton_iterations, "newton_iterations").summarized_as(spread));
  visit(number(&S::converged, "converged").summarized_as(ShotValue::frames_not, "not_converged"));
  visit(number(&S::energy, "energy_J")
            .in(joules)
            .summarized_as(spread)
            .in_wedge_as({"energy_J", Column::last_frame}));
}

/// Numbers of the surface that is rendered.
template <class Visit>
constexpr void visit_surface(Visit&& visit) {
  visit(rendered(&R::triangles, "render_triangles").summarized_as(spread).verified_within(0));
  visit(rendered(&R::stretch_mean, "render_stretch_mean_pct")
            .in(percent)
            .summarized_as(spread)
            .verified_within(1e-3));
  visit(rendered(&R::stretch_max, "render_stretch_max_pct")
            .in(percent)
            .summarized_as(spread)
            .verified_within(1e-3));
  visit(rendered(&R::ms, "render_ms").in(milliseconds).summarized_as(spread));
  visit(rendered(&R::crossings, "render_crossings").summarized_as(spread).verified_within(0));
  visit(rendered(&R::crossings_with_others, "render_crossings_with_others")
            .summarized_as(spread)
            .verified_within(0));
  visit(rendered(&R::kept_apart, nullptr));
}

/// Numbers of what it touches.
template <class Visit>
constexpr void visit_contacts(Visit&& visit) {
  visit(number(&S::crossings, "crossings").summarized_as(ShotValue::largest));
  visit(number(&S::crossings_with_others, "crossings_with_others"));
  visit(number(&S::touching, "touching"));
  visit(number(&S::touching_others, "touching_others"));
  visit(number(&S::on_colliders, "on_colliders"));
  visit(
      number(&S::inside, "inside_mm").in(millimetres).summarized_as(spread).verified_within(1e-3));
}

/// Numbers that only checkpoints keep.
template <class Visit>
constexpr void visit_state(Visit&& visit) {
  visit(number(&S::inside_colliders, nullptr));
  visit(number(&S::membrane_energy, nullptr));
  visit(number(&S::plastic, nullptr));
  visit(number(&S::doublings, nullptr));
  visit(number(&S::mesh_error, nullptr));
  visit(number(&S::contact, nullptr));
  visit(number(&S::remesh, nullptr));
  visit(number(&S::remesh_rise, nullptr));
}

}  // namespace statistics

/// Calls visit(field) for every number of a frame, in the order of cert/frames.jsonl; `field` is a
/// StatisticField. Checkpoints, the certificate, its summary, the curves of the report and the
/// table of a wedge are written from these rows.
template <class Visit>
constexpr void visit_frame_statistics(Visit&& visit) {
  statistics::visit_mesh(visit);
  statistics::visit_step(visit);
  statistics::visit_surface(visit);
  statistics::visit_contacts(visit);
  statistics::visit_state(visit);
}

}  // namespace paperbake
