#include "core/step1_elastic/contact/friction_history.h"

namespace paperbake {

Vector3d FrictionHistory::shear(const TouchingFeatures& contact) const {
  const auto found = shear_.find(contact);
  return found == shear_.end() ? Vector3d(Vector3d::Zero()) : found->second;
}

void FrictionHistory::archive(Serializer& a) {
  std::vector<int> names;
  Points3 shear(shear_.size(), 3);
  for (const auto& [contact, s] : shear_) {
    shear.row(names.size() / 6) = s.transpose();
    names.insert(names.end(), contact.body.begin(), contact.body.end());
    names.insert(names.end(), contact.vertices.begin(), contact.vertices.end());
  }
  a(names, shear);
  if (!a.reads()) return;
  a.require(names.size() == 6 * static_cast<std::size_t>(shear.rows()));
  shear_.clear();
  for (int k = 0; k < shear.rows(); ++k) {
    const int* name = names.data() + 6 * k;
    a.require(shear.row(k).norm() < 2 * sticking_shear);
    shear_[{{name[0], name[1]}, {name[2], name[3], name[4], name[5]}}] = shear.row(k).transpose();
  }
}

Eigen::Vector2d sheared(const Eigen::Vector2d& trial) {
  const double length = trial.norm();
  return length > sticking_shear ? Eigen::Vector2d(sticking_shear / length * trial) : trial;
}

}  // namespace paperbake
