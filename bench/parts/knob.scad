// Knob of 46 mm with grip grooves, a domed top and a D-shaped shaft hole.
$fn = 90;
difference() {
  intersection() {
    cylinder(d = 46, h = 26);
    translate([0, 0, -30]) sphere(r = 57, $fn = 120);
  }
  for (i = [0 : 17]) rotate(i * 20) translate([24.5, 0, 4]) cylinder(d = 5, h = 40, $fn = 24);
  translate([0, 0, -1]) difference() { cylinder(d = 6.2, h = 17); translate([1.6, -5, -1]) cube([10, 10, 30]); }
}
