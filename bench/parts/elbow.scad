// Pipe elbow: bore of 24 mm, wall of 8 mm, a bolted flange at each end.
$fn = 64;
module flange() { difference() { cylinder(d = 70, h = 10); for (i = [0 : 5]) rotate(i * 60 + 30) translate([28, 0, -1]) cylinder(d = 6.5, h = 12); } }
difference() {
  union() {
    rotate_extrude(angle = 90) translate([45, 0]) circle(d = 40);
    translate([45, 0.01, 0]) rotate([90, 0, 0]) flange();
    translate([0.01, 45, 0]) rotate([0, -90, 0]) flange();
  }
  rotate_extrude(angle = 90) translate([45, 0]) circle(d = 24);
  translate([45, 1, 0]) rotate([90, 0, 0]) cylinder(d = 24, h = 20);
  translate([1, 45, 0]) rotate([0, -90, 0]) cylinder(d = 24, h = 20);
}
