// A box for the sensor that lies flat on all six faces, millimetres. The rim round the pocket is
// the face Z+, the cable leaves through the slot in Y- and never lies under the box: on Y- it
// comes out of the slot at the side of Z+. sixflip_box.stl is made of this by `make box`.

length = 60;        // along x
width = 50;         // along y
height = 40;        // along z
pocket_length = 30; // for a module of up to 29 x 23 mm, on the pocket's floor
pocket_width = 24;
floor = 12;         // below the pocket
slot = 8;           // width of the cable's way out
letter_size = 8;    // of the letters on the faces
engraved = 0.6;     // their depth

// what stands on a face, its middle beside that of the face: along the face's own right and up
letters = [["X+", 0, 0], ["X-", 0, 0], ["Y+", 0, 0], ["Y-", -17, 0], ["Z+", 0, 18.5], ["Z-", 0, 0]];

// strokes of each letter, in heights of it; drawn here, since fonts differ from machine to machine
X = [[[0, 0], [0.6, 1]], [[0, 1], [0.6, 0]]];
Y = [[[0, 1], [0.3, 0.5]], [[0.6, 1], [0.3, 0.5]], [[0.3, 0.5], [0.3, 0]]];
Z = [[[0, 1], [0.6, 1]], [[0.6, 1], [0, 0]], [[0, 0], [0.6, 0]]];
MINUS = [[[1, 0.5], [1.6, 0.5]]];
PLUS = [[[1, 0.5], [1.6, 0.5]], [[1.3, 0.2], [1.3, 0.8]]];

function strokes(name) = concat(name[0] == "X" ? X : name[0] == "Y" ? Y : Z,
                                name[1] == "+" ? PLUS : MINUS);

module letter(name) {
    translate([-0.8 * letter_size, -letter_size / 2, -engraved])
        linear_extrude(engraved + 1)
            for (s = strokes(name))
                hull() for (end = s)
                    translate(letter_size * end) square(letter_size / 6, center = true);
}

// the face's middle to the origin of the letter, its outside up
module on_face(face) {
    if (face == 0) translate([length / 2, 0, 0]) rotate([90, 0, 90]) children();
    if (face == 1) translate([-length / 2, 0, 0]) rotate([90, 0, -90]) children();
    if (face == 2) translate([0, width / 2, 0]) rotate([90, 0, 180]) children();
    if (face == 3) translate([0, -width / 2, 0]) rotate([90, 0, 0]) children();
    if (face == 4) translate([0, 0, height / 2]) children();
    if (face == 5) translate([0, 0, -height / 2]) rotate([180, 0, 0]) children();
}

difference() {
    cube([length, width, height], center = true);
    translate([-pocket_length / 2, -pocket_width / 2, -height / 2 + floor])
        cube([pocket_length, pocket_width, height]);
    translate([-slot / 2, -width, -height / 2 + floor])
        cube([slot, width, height]);
    for (k = [0 : 5])
        on_face(k) translate([letters[k][1], letters[k][2], 0]) letter(letters[k][0]);
}
