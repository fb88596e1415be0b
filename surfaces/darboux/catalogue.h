/// \file catalogue.h
/// The list of all surfaces. A surface in it has its command-line name, its tests, its rows in the reports.
#pragma once

#include <darboux/bezier_patch.h>
#include <darboux/bilinear_patch.h>
#include <darboux/bspline_patch.h>
#include <darboux/catenoid.h>
#include <darboux/cone.h>
#include <darboux/cylinder.h>
#include <darboux/disk.h>
#include <darboux/ellipsoid.h>
#include <darboux/elliptic_paraboloid.h>
#include <darboux/enneper.h>
#include <darboux/extrusion.h>
#include <darboux/graph.h>
#include <darboux/helicoid.h>
#include <darboux/hyperbolic_paraboloid.h>
#include <darboux/klein_bottle.h>
#include <darboux/moebius_strip.h>
#include <darboux/monkey_saddle.h>
#include <darboux/one_sheet_hyperboloid.h>
#include <darboux/plane.h>
#include <darboux/pseudosphere.h>
#include <darboux/ruled_surface.h>
#include <darboux/sphere.h>
#include <darboux/superellipsoid.h>
#include <darboux/surface_of_revolution.h>
#include <darboux/torus.h>
#include <darboux/tube.h>
#include <darboux/two_sheet_hyperboloid.h>

namespace darboux {

/// A list of surface types.
template <class... Surfaces>
struct SurfaceList {
  /// Calls f(Surface{}), with default parameters, for each surface.
  template <class F>
  static void for_each(F&& f) {
    (f(Surfaces{}), ...);
  }
};

using Catalogue = SurfaceList<Sphere<>,                //
                              Torus<>,                 //
                              Cylinder<>,              //
                              Cone<>,                  //
                              Plane<>,                 //
                              Disk<>,                  //
                              Ellipsoid<>,             //
                              EllipticParaboloid<>,    //
                              HyperbolicParaboloid<>,  //
                              OneSheetHyperboloid<>,   //
                              TwoSheetHyperboloid<>,   //
                              Helicoid<>,              //
                              Catenoid<>,              //
                              MoebiusStrip<>,          //
                              KleinBottle<>,           //
                              Enneper<>,               //
                              MonkeySaddle<>,          //
                              Pseudosphere<>,          //
                              Superellipsoid<>,        //
                              Tube<>,                  //
                              BilinearPatch<>,         //
                              BezierPatch<>,           //
                              BSplinePatch<>,          //
                              SurfaceOfRevolution<>,   //
                              Extrusion<>,             //
                              RuledSurface<>,          //
                              Graph<>>;

}  // namespace darboux
