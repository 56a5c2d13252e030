/* JPEG, through libjpeg. It leaves by longjmp where it fails: what has to be there afterwards lies
 * in the caller's gtx_codec and in `state`, outside of the function that calls setjmp. */
#include "image/png_jpeg/codec.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h> /* last: it has no header of its own for size_t and FILE */
#include <jerror.h>

/* Passes over the whole image that a progressive file may ask for: encoders make ten, and each may
 * be of a few bytes. */
enum { MAX_SCANS = 100 };

typedef struct state {
    struct jpeg_decompress_struct jpeg;
    struct jpeg_error_mgr errors;
    struct jpeg_progress_mgr progress;
    jmp_buf left;
    gtx_codec *codec;
    uint8_t *row;
} state;

static void tell(j_common_ptr jpeg)
{
    state *s = jpeg->client_data;
    char text[JMSG_LENGTH_MAX];
    s->errors.format_message(jpeg, text);
    if (!s->codec->message[0])
        snprintf(s->codec->message, sizeof s->codec->message, "JPEG: %.150s", text);
}

static void on_error(j_common_ptr jpeg)
{
    state *s = jpeg->client_data;
    tell(jpeg);
    s->codec->no_memory |= s->errors.msg_code == JERR_OUT_OF_MEMORY;
    longjmp(s->left, 1);
}

/* Warnings are of data that is lost, and whose pixels become grey: what is there is shown, as
 * browsers do. The first is why something fails later. */
static void on_message(j_common_ptr jpeg, int level)
{
    if (level < 0)
        tell(jpeg);
}

static void on_progress(j_common_ptr jpeg)
{
    state *s = jpeg->client_data;
    if (s->jpeg.input_scan_number <= MAX_SCANS)
        return;
    snprintf(s->codec->message, sizeof s->codec->message, "JPEG: more than %d scans", MAX_SCANS);
    longjmp(s->left, 1);
}

/* Stored inverted: as much of a colour is left as there is no ink, neither of it nor black. */
static void from_cmyk(const uint8_t *cmyk, uint8_t *out, size_t count, uint32_t channels)
{
    for (size_t i = 0; i < count; ++i, cmyk += 4, out += channels) {
        for (int c = 0; c < 3; ++c)
            out[c] = (uint8_t)((cmyk[c] * cmyk[3] + 127) / 255);
        if (channels == 4)
            out[3] = 255;
    }
}

static int read_pixels(state *s)
{
    struct jpeg_decompress_struct *jpeg = &s->jpeg;
    gtx_codec *codec = s->codec;
    const int is_inks = jpeg->jpeg_color_space == JCS_CMYK || jpeg->jpeg_color_space == JCS_YCCK;
    const int is_grey = jpeg->num_components == 1;
    if (!is_inks && !is_grey && jpeg->num_components != 3) {
        snprintf(codec->message, sizeof codec->message, "a JPEG of %d components",
                 jpeg->num_components);
        return 1;
    }
    codec->depth = 1;
    codec->channels = codec->wanted == GTX_CODEC_RGBA ? 4 : is_grey ? 1 : 3;
    jpeg->out_color_space = is_inks                ? JCS_CMYK
                            : codec->channels == 4 ? JCS_EXT_RGBA
                            : is_grey              ? JCS_GRAYSCALE
                                                   : JCS_RGB;
    if (!gtx_codec_take(codec))
        return 1;
    jpeg_start_decompress(jpeg);
    if (is_inks)
        s->row = malloc((size_t)codec->width * 4);
    if (is_inks && !s->row) {
        codec->no_memory = 1;
        return 1;
    }
    while (jpeg->output_scanline < codec->height) {
        uint8_t *row = (uint8_t *)codec->pixels +
                       (size_t)jpeg->output_scanline * codec->width * codec->channels;
        JSAMPROW to = is_inks ? s->row : row;
        jpeg_read_scanlines(jpeg, &to, 1);
        if (is_inks)
            from_cmyk(s->row, row, codec->width, codec->channels);
    }
    return 0;
}

static int read_all(state *s, FILE *file)
{
    if (setjmp(s->left))
        return 1;
    jpeg_create_decompress(&s->jpeg);
    s->progress.progress_monitor = on_progress;
    s->jpeg.progress = &s->progress;
    jpeg_stdio_src(&s->jpeg, file);
    jpeg_read_header(&s->jpeg, TRUE);
    s->codec->width = s->jpeg.image_width;
    s->codec->height = s->jpeg.image_height;
    return s->codec->wanted != GTX_CODEC_SIZE && read_pixels(s);
}

int gtx_jpeg_decode(FILE *file, gtx_codec *codec)
{
    state s = {.codec = codec};
    s.jpeg.err = jpeg_std_error(&s.errors);
    s.errors.error_exit = on_error;
    s.errors.emit_message = on_message;
    s.jpeg.client_data = &s;
    const int failed = read_all(&s, file);
    free(s.row);
    jpeg_destroy_decompress(&s.jpeg);
    return failed;
}
