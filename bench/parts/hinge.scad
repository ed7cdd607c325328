// Hinge printed in place: two leaves of 6 mm and a pin, three shells that do not touch.
$fn = 48;
module leaf(side) {
  difference() {
    union() {
      translate([side * 8, -25, 0]) mirror([side < 0 ? 1 : 0, 0, 0]) cube([32, 50, 6]);
      for (y = side > 0 ? [-25, 5] : [-9.5]) translate([0, y, 7]) rotate([-90, 0, 0]) hull() { cylinder(d = 14, h = side > 0 ? 15 : 14); translate([side * 9, 3.5, 0]) cylinder(d = 6.9, h = side > 0 ? 15 : 14); }
    }
    translate([0, -30, 7]) rotate([-90, 0, 0]) cylinder(d = 7, h = 60);
  }
}
leaf(1);
leaf(-1);
translate([0, -25, 7]) rotate([-90, 0, 0]) cylinder(d = 6, h = 50);
