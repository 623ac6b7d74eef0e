#include "core/model/serializer.h"
#include "core/step1_elastic/elastic.h"

namespace paperbake {

static void archive(Archive& a, SecondWay& w) { a(w.x, w.leg, w.tries, w.converged); }

void archive(Archive& a, ElasticPast& p) {
  a(p.positions, p.steps, p.remeshed, p.careful, p.content_until, p.descending, p.second,
    p.ridges.share, p.ridges.focus);
}

void archive(Archive& a, Held& h) { a(h.vertices, h.targets, h.stiffness); }

}  // namespace paperbake
