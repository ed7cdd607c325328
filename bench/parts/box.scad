// Open box of 90 x 60 x 45 mm: walls of 6 mm, rounded corners, a ledge for a lid.
$fn = 40;
module rounded(x, y, r) { offset(r) square([x - 2 * r, y - 2 * r], center = true); }
difference() {
  linear_extrude(45) rounded(90, 60, 8);
  translate([0, 0, 6]) linear_extrude(40) rounded(78, 48, 4);
  translate([0, 0, 41]) linear_extrude(5) rounded(84, 54, 6);
}
