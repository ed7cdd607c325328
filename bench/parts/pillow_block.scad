// Pillow block for a bearing of 32 mm: a thick foot, two bolts, a bridge over the bearing.
$fn = 72;
difference() {
  union() {
    translate([-50, -15, 0]) cube([100, 30, 14]);
    translate([0, 15, 32]) rotate([90, 0, 0]) cylinder(d = 56, h = 30);
    translate([-28, -15, 0]) cube([56, 30, 32]);
  }
  translate([0, 11, 32]) rotate([90, 0, 0]) cylinder(d = 32, h = 30);
  translate([0, 20, 32]) rotate([90, 0, 0]) cylinder(d = 24, h = 40);
  for (x = [-40, 40]) translate([x, 0, -1]) { cylinder(d = 8.4, h = 20); translate([0, 0, 10]) cylinder(d = 15, h = 10); }
}
