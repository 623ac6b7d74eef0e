#include "core/pattern_samples.h"
#include "core/polish.h"
#include "core/curved_surface.h"
#include "tests/bench/against_fem.h"
#include <cstdio>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <algorithm>
using namespace paperbake; using namespace paperbake::bench;
double cpu(){ timespec t; clock_gettime(CLOCK_THREAD_CPUTIME_ID,&t); return 1e3*t.tv_sec+1e-6*t.tv_nsec; }
int main(int argc,char**argv){
  const int size = argc>1?std::atoi(argv[1]):1700; const int every=argc>2?std::atoi(argv[2]):12;
  for(const Case& c: cases_named({argv+std::min(argc,3),argv+argc})){
    const auto [shot,fps]=shot_of(c); const double side=longer_side(shot.pattern);
    const Run ref=run_fem(shot,6000,c,fps);
    const Run f17=run_fem(shot,1700,c,fps);
    std::printf("%s fem1700 %.1f ms %.3f%%; fem6000 %.1f ms\n",c.name,f17.elastic_ms,rms_pct(f17,ref,side),ref.elastic_ms);
    AnimateOptions o; o.fps=fps;o.last_frame=c.last_frame;o.elastic.gravity=c.gravity;
    ElasticOptions eo=o.elastic; if(getenv("STOP")) eo.stop=atof(getenv("STOP"));
    double b=cpu(); Polisher polish(shot,eo,size); const double mk=cpu()-b; const int n2=getenv("N2")?atoi(getenv("N2")):600; Polisher polish2(shot,eo,n2);
    const PatternSamples samples(shot.pattern,41);
    double sum=0; int n=0; double rs=0, rh=0;
    animate(shot,hybrid(shot.pattern,shot.paper,120,{},0,0),o,[&](const AnimatedFrame&f){
      if(f.frame%every) return true;
      std::vector<int> held; Points3 at(0,3);
      for(size_t h=0;h<f.handles.size();++h) if(f.handles[h].state!=HandleFrame::free){held.push_back(h);at.conservativeResize(held.size(),3);at.bottomRows(1)=f.handles[h].at.transpose();}
      double t=cpu(); const Polished p=polish(*f.sheet,held,at); t=cpu()-t;
      Sheet g=p.sheet; { const auto cs=curve(*f.sheet); const Locator L(f.sheet->pattern,f.sheet->triangles); for(int v=0;v<g.x.rows();++v) g.x.row(v)=cs.at(L.locate(g.pattern.row(v))); } const double facet=100/side*rms_distance(samples(*f.sheet).x,ref.frames[f.frame-1]), es=100/side*rms_distance(samples(g).x,samples(p.sheet).x); const double h=100/side*rms_distance(samples(g).x,ref.frames[f.frame-1]), q=100/side*rms_distance(samples(p.sheet).x,ref.frames[f.frame-1]);
      const double q17=100/side*rms_distance(samples(p.sheet).x,f17.frames[f.frame-1]);
      std::printf("  f%3d est %.3f (vertices %.3f) true %.3f (facets %.3f) ratio %.2f | polished %.3f (to fem1700 %.3f) it %d settlings %d %s E %.3g -> %.3g (hyb %.3g) %.0f ms\n",f.frame,es,100*p.moved/side,h,facet,es/h,q,q17,p.iterations,0,p.converged?"":"NC",p.energy_before,p.energy,f.energy,t);
      std::fflush(stdout);
      double t2=cpu(); const Polished p2=polish2(*f.sheet,held,at); t2=cpu()-t2;
      const Points3 a=samples(p.sheet).x,bb=samples(p2.sheet).x; const double r=double(p2.sheet.triangles.rows())/p.sheet.triangles.rows();
      const double d=100/side*rms_distance(a,bb);
      for(double q: {1.0,0.5}){ const double rr=std::pow(r,q); const Points3 lim=a+rr/(1-rr)*(a-bb); const double e=100/side*rms_distance(samples(g).x,lim); std::printf("     richardson q %.1f: est %.3f ratio %.2f, limit off %.3f; levels differ %.3f %.0f ms\n",q,e,e/h,100/side*rms_distance(lim,ref.frames[f.frame-1]),d,t2);}
      sum+=t;++n;rs+=q;rh+=h;return true;});
    std::printf("  mean polished %.3f hybrid %.3f  %.0f ms, mesh %.0f ms\n",rs/n,rh/n,sum/n,mk);
  }}
