' CATSMXT, version 1: hands the arm over to set points from the PC until the PC ends it.
' Set the address of the PC in the Open statement. 10 ms is the filter over the set points.
Wait M_Svo=1
*AGAIN
Open "ENET:192.168.0.10" As #1
Mxt 1,1,10
Close #1
GoTo *AGAIN
