#pragma once

#include <optional>
#include <type_traits>
#include <utility>

namespace paperbake {

/// How good the surface is that is rendered, in one frame of one sheet.
struct RenderStatistics {
  int triangles = 0;
  double stretch_mean = 0;  // [1] mean |l-L|/L over its edges
  double stretch_max = 0;   // [1] largest |l-L|/L of an edge
  double ms = 0;            // [ms] CPU time of positions and normals; 0 for a simulated mesh
  int crossings = 0;        // pairs of its triangles that pass through each other
  // pairs of one of its triangles and one of a sheet before it in the scene that do
  int crossings_with_others = 0;
  // parts that would have passed through each other were taken apart
  bool kept_apart = false;
};

/// The numbers of one frame of one sheet, in SI units and milliseconds. Each has a row in
/// visit_frame_statistics below; checkpoints, the certificate, its summary, the curves of the
/// report and the table of a wedge are written from there. A new number is a field here and a row
/// there.
struct FrameStatistics {
  // of the simulated mesh after step 3, measured by whoever records the frame; the handle error is
  // measured again on what is handed on
  int triangles = 0;
  double stretch_mean = 0;      // [1] c_m = mean |l-L|/L over its edges
  double stretch_max = 0;       // [1] largest |l-L|/L of an edge
  double angle_defect_max = 0;  // [rad] largest angle defect of a vertex
  double handle_error_max = 0;  // [m] largest HandleFrame::error
  int singular = 0;             // singular points so far
  int folds = 0;                // crease lines that are folded so far
  int crossings = 0;            // pairs of its triangles that pass through each other
  // pairs of one of its triangles and one of a sheet before it in the scene that do
  int crossings_with_others = 0;
  // since the frame before that is recorded; 0 in the first
  double moved = 0;   // [m] root mean square over the sheet
  double driven = 0;  // [m] farthest way of what drives it: of a handle or of a collider

  // of what is handed on; of the simulated mesh where nothing is
  double inside = 0;  // [m] how deep its deepest point is inside a collider

  // told by the simulation
  int new_singular = 0;    // singular points born in this frame
  double elastic_ms = 0;   // [ms] CPU time of step 1, over all threads
  double geometry_ms = 0;  // [ms] CPU time of everything else that touches the sheet
  bool inertia = false;    // the sheet moves with inertia
  int substeps = 1;
  int newton_iterations = 0;
  bool converged = true;
  double energy = 0;            // [J] stored in the sheet
  double membrane_energy = 0;   // [J] its stretching part
  double plastic = 0;           // [m rad] integral of the plastic curvature over the pattern so far
  bool contact = false;         // the sheet came near itself and was kept from passing through
  int touching = 0;             // pairs of its features that contact keeps apart
  int touching_others = 0;      // pairs of one of its features and one of another sheet
  int on_colliders = 0;         // vertices, edges and triangles that colliders push
  double inside_colliders = 0;  // [m] how deep the deepest of them is, as the solver sees it
  // what became of the mesh that the method proposed
  enum Remesh { none, accepted, rejected } remesh = none;
  double remesh_rise = 0;  // [1] rise of the potential with it, as a share of the stored energy

  std::optional<RenderStatistics> render;  // empty until the frame was rendered
};

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

/// Calls visit(field) for every number of a frame, in the order of cert/frames.jsonl; `field` is a
/// StatisticField.
template <class Visit>
constexpr void visit_frame_statistics(Visit&& visit) {
  using S = FrameStatistics;
  using R = RenderStatistics;
  using Curve = ReportCurve;
  using Column = WedgeColumn;
  const auto number = [](auto S::*member, const char* name) {
    return StatisticField<S, std::decay_t<decltype(std::declval<S>().*member)>>{member, name};
  };
  const auto rendered = [](auto R::*member, const char* name) {
    return StatisticField<R, std::decay_t<decltype(std::declval<R>().*member)>>{member, name};
  };
  constexpr StatisticUnit percent{"%", 100}, degrees{"deg", 180, 3.14159265358979323846},
      millimetres{"mm", 1e3}, milliseconds{"ms"}, joules{"J"};
  constexpr auto spread = ShotValue::spread;

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
  visit(number(&S::crossings, "crossings").summarized_as(ShotValue::largest));
  visit(number(&S::crossings_with_others, "crossings_with_others"));
  visit(number(&S::touching, "touching"));
  visit(number(&S::touching_others, "touching_others"));
  visit(number(&S::on_colliders, "on_colliders"));
  visit(
      number(&S::inside, "inside_mm").in(millimetres).summarized_as(spread).verified_within(1e-3));

  visit(number(&S::inside_colliders, nullptr));
  visit(number(&S::membrane_energy, nullptr));
  visit(number(&S::plastic, nullptr));
  visit(number(&S::contact, nullptr));
  visit(number(&S::remesh, nullptr));
  visit(number(&S::remesh_rise, nullptr));
}

}  // namespace paperbake
