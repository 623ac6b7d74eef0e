#include "core/model/plastic_grid.h"

#include "core/model/segment2.h"
#include "core/model/serializer.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr int cells_along = 64;

double frobenius(const Eigen::Vector4d& memory) {
  return std::sqrt(memory[0] * memory[0] + 2 * memory[1] * memory[1] + memory[2] * memory[2]);
}

}  // namespace

PlasticGrid::PlasticGrid(const Pattern& pattern) : size_(longer_side(pattern) / cells_along) {
  const Vector2d box = extent(pattern);
  columns_ = std::clamp(static_cast<int>(std::ceil(box.x() / size_ - 1e-9)), 1, cells_along);
  rows_ = std::clamp(static_cast<int>(std::ceil(box.y() / size_ - 1e-9)), 1, cells_along);
  cells_.resize(columns_ * rows_);
  std::vector<int> front;
  for (int c = 0; c < static_cast<int>(cells_.size()); ++c) {
    cells_[c].inside = contains(pattern, centre(c % columns_, c / columns_));
    if (!cells_[c].inside) continue;
    cells_[c].nearest = c;
    front.push_back(c);
  }
  if (front.empty())  // a pattern thinner than a cell
    for (int c = 0; c < static_cast<int>(cells_.size()); ++c) {
      cells_[c].inside = true;
      cells_[c].nearest = c;
      front.push_back(c);
    }
  area_inside_ = area(pattern) / front.size();

  // from the inside cells outwards, ring by ring
  for (std::size_t k = 0; k < front.size(); ++k) {
    const int column = front[k] % columns_, row = front[k] / columns_;
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c) {
        Cell& cell = cells_[r * columns_ + c];
        if (cell.nearest >= 0) continue;
        cell.nearest = cells_[front[k]].nearest;
        front.push_back(r * columns_ + c);
      }
  }
}

std::vector<int> PlasticGrid::centres_in(const Vector2d (&corner)[3]) const {
  Eigen::AlignedBox2d box;
  for (const Vector2d& p : corner) box.extend(p);
  const auto first = [&](double low) {
    return std::max(0, static_cast<int>(std::floor(low / size_ - 0.5)));
  };
  const auto last = [&](double high, int count) {
    return std::min(count - 1, static_cast<int>(std::ceil(high / size_ - 0.5)));
  };
  // a centre on an edge belongs to the first triangle that asks
  const double rounding = -1e-9 * size_ * size_;
  std::vector<int> found;
  for (int r = first(box.min().y()); r <= last(box.max().y(), rows_); ++r)
    for (int c = first(box.min().x()); c <= last(box.max().x(), columns_); ++c) {
      const Vector2d p = centre(c, r);
      if (cross(corner[1] - corner[0], p - corner[0]) >= rounding &&
          cross(corner[2] - corner[1], p - corner[1]) >= rounding &&
          cross(corner[0] - corner[2], p - corner[2]) >= rounding)
        found.push_back(r * columns_ + c);
    }
  return found;
}

PlasticGrid::Cover PlasticGrid::cover(const Points2& pattern, const Triangles& triangles) const {
  Cover cover;
  std::vector<bool> taken(cells_.size(), false);
  // readers: total area of the triangles that read a cell [m2]
  std::vector<double> area(triangles.rows()), readers(cells_.size(), 0.0);
  for (int t = 0; t < triangles.rows(); ++t) {
    const Vector2d corner[3] = {pattern.row(triangles(t, 0)), pattern.row(triangles(t, 1)),
                                pattern.row(triangles(t, 2))};
    area[t] = signed_area(corner[0], corner[1], corner[2]);
    cover.first.push_back(static_cast<int>(cover.cell.size()));
    for (int c : centres_in(corner))
      if (cells_[c].inside && !taken[c]) {
        taken[c] = true;
        cover.cell.push_back(c);
      }
    if (cover.first.back() == static_cast<int>(cover.cell.size())) {
      const Vector2d middle = (corner[0] + corner[1] + corner[2]) / (3 * size_);
      const int column = std::clamp(static_cast<int>(middle.x()), 0, columns_ - 1);
      const int row = std::clamp(static_cast<int>(middle.y()), 0, rows_ - 1);
      cover.cell.push_back(cells_[row * columns_ + column].nearest);
    }
    for (std::size_t k = cover.first.back(); k < cover.cell.size(); ++k)
      readers[cover.cell[k]] += area[t];
  }
  cover.first.push_back(static_cast<int>(cover.cell.size()));

  cover.share.resize(cover.cell.size());
  for (int t = 0; t < triangles.rows(); ++t)
    for (int k = cover.first[t]; k < cover.first[t + 1]; ++k)
      cover.share[k] = area[t] / readers[cover.cell[k]];
  return cover;
}

PlasticMemory PlasticGrid::read(const Cover& cover) const {
  const int triangles = static_cast<int>(cover.first.size()) - 1;
  PlasticMemory memory(triangles);
  if (is_virgin_) return memory;
  for (int t = 0; t < triangles; ++t) {
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    double ridge = 0;
    for (int k = cover.first[t]; k < cover.first[t + 1]; ++k) {
      sum += cells_[cover.cell[k]].memory;
      ridge += cells_[cover.cell[k]].ridge;
    }
    sum /= cover.first[t + 1] - cover.first[t];
    memory.ridge[t] = ridge / (cover.first[t + 1] - cover.first[t]);
    memory.curvature.row(t) = sum.head<3>();
    memory.hardening[t] = sum[3];
  }
  return memory;
}

Points3 PlasticGrid::at_vertices(const Points2& pattern, const Triangles& triangles) const {
  if (is_virgin()) return Points3::Zero(pattern.rows(), 3);
  const Points3 kept = read(cover(pattern, triangles)).curvature;
  Points3 sum = Points3::Zero(pattern.rows(), 3);
  Eigen::VectorXd area = Eigen::VectorXd::Zero(pattern.rows());
  for (int t = 0; t < triangles.rows(); ++t) {
    const Vector2d corner[3] = {pattern.row(triangles(t, 0)), pattern.row(triangles(t, 1)),
                                pattern.row(triangles(t, 2))};
    const double weight = signed_area(corner[0], corner[1], corner[2]);
    for (int k = 0; k < 3; ++k) {
      sum.row(triangles(t, k)) += weight * kept.row(t);
      area[triangles(t, k)] += weight;
    }
  }
  for (int v = 0; v < sum.rows(); ++v)
    if (area[v] > 0) sum.row(v) /= area[v];
  return sum;
}

double PlasticGrid::write(const Cover& cover, const PlasticMemory& gained) {
  double growth = 0;
  for (int t = 0; t < gained.hardening.size(); ++t) {
    Eigen::Vector4d gain;
    gain << gained.curvature.row(t).transpose(), gained.hardening[t];
    if (gain.isZero(0)) continue;
    is_virgin_ = false;
    for (int k = cover.first[t]; k < cover.first[t + 1]; ++k) {
      Eigen::Vector4d& memory = cells_[cover.cell[k]].memory;
      growth -= frobenius(memory);
      memory += cover.share[k] * gain;
      growth += frobenius(memory);
      double& ridge = cells_[cover.cell[k]].ridge;
      ridge = std::max(ridge, gained.ridge[t]);
    }
  }
  return area_inside_ * growth;
}

void PlasticGrid::reset() {
  if (is_virgin_) return;
  for (Cell& cell : cells_) {
    cell.memory.setZero();
    cell.ridge = 0;
  }
  is_virgin_ = true;
}

void PlasticGrid::archive(Serializer& a) {
  std::vector<int> written;
  for (int c = 0; c < static_cast<int>(cells_.size()); ++c)
    if (!cells_[c].memory.isZero(0) || cells_[c].ridge != 0) written.push_back(c);
  a(written);
  if (a.reads()) reset();
  for (const int c : written) {
    a.require(c >= 0 && c < static_cast<int>(cells_.size()));
    a(cells_[c].memory, cells_[c].ridge);
  }
  a(is_virgin_);
}

double PlasticGrid::integral() const {
  if (is_virgin_) return 0;
  double sum = 0;
  for (const Cell& cell : cells_) sum += frobenius(cell.memory);
  return area_inside_ * sum;
}

}  // namespace paperbake
