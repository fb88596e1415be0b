# gnuplot -e "data='work-precision.csv'; picture='work-precision.svg'" work_precision.gp
# Time a point against error, one panel a surface: filled marks double, hollow marks float.
set datafile separator ','
set terminal svg size 1200,1400 font 'sans-serif,13' background '#ffffff'
set output picture
set logscale xy
set format x '%g'
set format y '10^{%L}'
set xrange [1:20000]
set yrange [1e-17:1]
set grid xtics ytics lc rgb '#dddddd' lt 1
unset mytics
set ylabel 'largest error'

# The larger of the two errors, none below what the axis shows.
error(frame, partial) = (frame > partial ? frame : partial) < 2e-17 ? 2e-17 : (frame > partial ? frame : partial)
# A row of this surface, scalar and methods that begin so; others are left out.
wanted(s, t, m) = strcol(1) eq s && strcol(2) eq t && strcol(3)[1:strlen(m)] eq m

methods = 'naive closed-form dual differences occt darboux'
titles = '"naive Eigen loop" "closed form, scalar" "dual numbers" "central differences, order 2 to 8" "OCCT, D1 and D2" "Darboux: points, baseline, AVX2, AVX-512"'
colours = '#666666 #b07000 #7a3fb0 #c02020 #108040 #1060c0'
filled = '5 7 9 13 11 15'
hollow = '4 6 8 12 10 14'
surfaces = 'torus sphere ellipsoid klein-bottle superellipsoid tube pseudosphere bspline-patch'

set multiplot layout 5,2 margins 0.08,0.98,0.02,0.97 spacing 0.09,0.05
do for [i=1:words(surfaces)] {
  s = word(surfaces, i)
  if (i > words(surfaces) - 2) { set xlabel 'nanoseconds a point' }
  set title s offset 0,-0.6
  unset key
  plot for [k=1:6] data using (wanted(s, 'double', word(methods, k)) ? column(4) : NaN):(error(column(5), column(6))) \
         with points pt int(word(filled, k)) ps 0.9 lc rgb word(colours, k) notitle, \
       for [k=1:6] data using (wanted(s, 'float', word(methods, k)) ? column(4) : NaN):(error(column(5), column(6))) \
         with points pt int(word(hollow, k)) ps 0.9 lc rgb word(colours, k) notitle
}
# The legend has the last two panels' place.
unset title
unset tics
unset border
unset grid
unset xlabel
unset ylabel
set key center top Left reverse samplen 1
plot for [k=1:6] NaN with points pt int(word(filled, k)) ps 0.9 lc rgb word(colours, k) title word(titles, k).', double'
plot for [k=1:6] NaN with points pt int(word(hollow, k)) ps 0.9 lc rgb word(colours, k) \
     title k == 5 ? '' : word(titles, k).', float'
unset multiplot
