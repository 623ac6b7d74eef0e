#pragma once

#include "baker/job/plan.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// Plans a bake. With --accuracy or --budget, first finds the size of the simulated mesh that they
/// ask for, and sets it in the settings: the shot is simulated on meshes of 120, 240, 480, ...
/// triangles (fem and adaptive: 250, 500, ...), and the distance between two successive results
/// tells the error of the coarser one (estimated_errors).
///
/// --accuracy  the coarsest mesh of which nine of ten frames are estimated to keep the accuracy
/// --budget    the finest mesh that can be found and simulated in this CPU time
///
/// A crumple has no one shape that finer meshes come nearer to: its singular points are drawn, and
/// small differences grow. Frames from the third singular point on do not count, nor do those from
/// where the results part.
///
/// plan    plans a bake with other settings of the same scene; without it the scene is read
/// log     receives a sentence on what is being done
/// throws  as plan_bake does
BakePlan plan_with_accuracy(BakeSettings&, const std::function<void(const std::string&)>& log);
BakePlan plan_with_accuracy(BakeSettings&, const std::function<void(const std::string&)>& log,
                            const std::function<BakePlan(const BakeSettings&)>& plan);

/// One sentence on what was chosen.
std::string describe(const AccuracyChoice&);

/// Errors of a result, frame by frame, from its distances to the next finer one.
/// With an error C n^-q of n triangles, the result on 2n triangles is nearer to the truth by the
/// factor r = 2^-q, and the distance of the two is (1 - r) times the error of the coarser one.
/// coarser  distances of the next coarser result to this one; empty: there is none, and r is 1/2
/// finer    distances of this result to the next finer one, in the same unit
/// returns  errors in that unit. r is the median of finer/coarser, within [1/4, 3/4]
/// source   [Richardson 1911]
std::vector<double> estimated_errors(const std::vector<double>& coarser,
                                     const std::vector<double>& finer);

/// The first frame from which finer meshes no longer come nearer to each other: in it, and in two
/// thirds of the frames from there to the end, the distance of the finer pair is larger than
/// `least`, and larger than 0.8 of that of the coarser pair.
/// returns  its index; the number of frames when there is none
std::size_t parting_frame(const std::vector<double>& coarser, const std::vector<double>& finer,
                          double least);

}  // namespace paperbake
