/* Takes the file DRIVE into memory. */

    .section .rodata
    .global drive_begin
    .global drive_end
drive_begin:
    .incbin DRIVE
drive_end:

/* No stack needs to be executable. */
    .section .note.GNU-stack, "", %progbits
